"""One flight: commands, feedback, actuators, gusts, damage; what happens is recorded exactly."""

import math
from dataclasses import dataclass, field

import numpy as np

import inputs
import stabilisation
from simulator import RHO, PSF, FT, Simulator

# Recorded exactly, 200 times per second; the instruments sample from it.
RECORD_HZ = 200
CHANNELS = ("tas", "alpha", "beta", "phi", "theta", "p", "q", "r", "ax", "ay", "az", "altitude", "density", "qbar", "thrust",
            "elevator", "aileron", "rudder", "p_air", "q_air", "r_air")
COEFFICIENTS = ("CL", "CD", "CY", "Cl", "Cm", "Cn")


@dataclass
class Plan:
    """What one flight does. Amplitudes are multiples of what the aircraft's own response asks for."""

    name: str
    group: str
    axes: str  # "longitudinal", "lateral", or "six" for both
    seed: int
    duration: float = 30.0
    rate_hz: int = 50
    # (pattern, surface, start s, factor on the amplitude); for what lasts, as "stick", its end as well: (.., factor, end).
    manoeuvres: tuple = ()
    # "open", "damper", "attitude", or "stabilised": a flight control system with gains of its own for each flight.
    loop: str = "open"
    # One sigma of gusts, m/s.
    gust: float = 0.0
    # JSBSim's own turbulence in place of these gusts, which turns the air as well: the wind at 20 feet, ft/s, and the severity (1 to 7)
    # of MIL-F-8785C.
    turning: tuple | None = None
    # (time s, change of the elevator rad, seconds it takes).
    retrims: tuple = ()
    # (time s, factor on the trim thrust).
    thrust: tuple = ()
    # time s, {parameter: fraction of its local derivative that is added; for "Cm_0" the elevator (rad) of the same moment}.
    damage: tuple | None = None
    instruments: dict = field(default_factory=dict)
    # {parameter: part of what a degree of the coefficient's main variable does} of a term that the aircraft has from the
    # beginning, and the model file has not.
    added: dict = field(default_factory=dict)
    kind: str = "sound"
    # Without thrust, on a path that descends.
    gliding: bool = False
    # The thrust goes with the airspeed to the power of minus this: 1 for a propeller with constant power, 0 for the constant thrust
    # of the other flights; and its line lies this part of the chord below the centre of gravity. Nobody records it then.
    propeller: tuple | None = None
    # With the engines, tanks and flight control system of the aircraft's own description; nobody records the thrust.
    whole: bool = False
    conditions: tuple = ()


@dataclass
class Flown:
    time: np.ndarray
    channels: dict
    coefficients: dict
    trim: dict
    changes: dict
    added: dict


def fly(sim: Simulator, plan: Plan, rng) -> Flown:
    """Flies `plan` and returns the exact record, 200 samples per second."""
    spec = sim.spec
    speed = spec.speed * rng.uniform(0.94, 1.08)
    altitude = spec.altitude * rng.uniform(0.9, 1.1)
    trim = sim.trim(speed, altitude, plan.gliding, plan.propeller[1] if plan.propeller else 0.0)
    if trim["residual"] > 1e-7:
        raise RuntimeError(f"{spec.name}: no trim at {speed:.0f} m/s (residual {trim['residual']:.1e})")
    m = sim.response(trim)
    step = sim.step_s
    count = int(round(plan.duration / step))
    time = np.arange(count + 1) * step
    commands = _commands(time, plan, m, speed, rng)
    wind = inputs.dryden(time, speed, plan.gust, min(533.0, altitude), rng) if plan.gust > 0 else None
    thrust = np.full(count + 1, trim["thrust"])
    for when, factor in plan.thrust:
        # An engine follows with a lag of 1.5 s.
        thrust += np.where(time > when, trim["thrust"] * (factor - 1) * (1 - np.exp(-np.maximum(time - when, 0) / 1.5)), 0.0)

    # Feedback, in units of what one radian of the surface does. The wings are kept level in longitudinal flights, and the
    # pitch attitude in lateral ones, as a pilot would.
    lateral = plan.axes != "longitudinal"
    system = stabilisation.system(plan, trim, m) if plan.loop == "stabilised" else None
    loop = "open" if system else plan.loop
    kq = {"open": 0.0, "damper": 1.2, "attitude": 1.0}[loop] if not lateral else 0.6
    ktheta = {"open": 0.0, "damper": 0.0, "attitude": 1.0}[loop] if not lateral else 0.4
    kp, kphi, kr = (0.8, 0.6, 0.4) if not lateral else {"open": (0, 0, 0), "damper": (1.0, 0, 0.6), "attitude": (0.8, 0.6, 0.6)}[loop]
    gq, gtheta = kq / abs(m["M_elevator"]), ktheta / abs(m["M_elevator"])
    gp, gphi, gr = kp / abs(m["L_aileron"]), kphi / abs(m["L_aileron"]), kr / abs(m["N_rudder"])
    changes_asked = _changes(sim, plan, trim)
    added = _added(sim, plan, trim)
    if wind is not None:
        sim.set_wind(*_to_earth(wind[0], trim["phi"], trim["theta"], 0.0))
    sim.begin(trim, plan.propeller[1] if plan.propeller else 0.0)
    sim.changes = dict(added)
    if plan.turning:
        sim.begin_turbulence(*plan.turning, plan.seed)
    every = int(round(1 / RECORD_HZ / step))
    rows, exact = [], []
    damage_at = math.inf
    changes: dict = {}
    if plan.damage:
        damage_at = plan.damage[0]
    get = sim.get
    for k in range(count + 1):
        if k > 0:
            sim.step()
        if k % every == 0:
            rows.append(_row(sim))
            exact.append(tuple(sim.coefficients().values()))
        if time[k] >= damage_at:
            changes = changes_asked
            sim.changes = changes | added
            damage_at = math.inf
        phi, theta = get("attitude/phi-rad"), get("attitude/theta-rad")
        p, q, r = get("velocities/p-rad_sec"), get("velocities/q-rad_sec"), get("velocities/r-rad_sec")
        asked = (
            trim["elevator"] + commands["elevator"][k] + gq * q + gtheta * (theta - trim["theta"]),
            trim["aileron"] + commands["aileron"][k] + gp * p + gphi * (phi - trim["phi"]),
            trim["rudder"] + commands["rudder"][k] + gr * r,
        )
        if system:
            feedback = system.step(step, phi, theta, p, q, r, get("aero/beta-rad"), get("position/h-sl-ft") * FT, sim.surfaces["aileron"] - trim["aileron"])
            asked = tuple(a + b for a, b in zip(asked, feedback))
        sim.follow(asked)
        power = plan.propeller[0] if plan.propeller else 0.0
        sim.set_thrust(thrust[k] * (speed / (get("velocities/vt-fps") * FT)) ** power)
        if wind is not None:
            sim.set_wind(*_to_earth(wind[k], phi, theta, get("attitude/psi-rad")))
        if abs(phi) > 1.3 or abs(theta) > 0.9 or not math.isfinite(q):
            raise RuntimeError(f"{spec.name} {plan.name}: it does not fly level any more at {time[k]:.1f} s")
    rows = np.array(rows)
    exact = np.array(exact)
    return Flown(
        time[::every],
        {name: rows[:, i] for i, name in enumerate(CHANNELS)},
        {name: exact[:, i] for i, name in enumerate(COEFFICIENTS)},
        trim | {"response": m},
        changes,
        added,
    )


def _changes(sim: Simulator, plan: Plan, trim: dict) -> dict:
    """By how much the damage changes each parameter."""
    if not plan.damage:
        return {}
    changes = {}
    for name, factor in plan.damage[1].items():
        coefficient, variable = name.split("_", 1)
        surface = {"Cm": "elevator", "Cl": "aileron", "Cn": "rudder"}.get(coefficient)
        changes[name] = factor * sim.derivative(trim, coefficient, surface if variable == "0" else variable)
    return changes


# What moves each coefficient most, and the motion of the terms that may be added, in rad (V: as a part of the speed).
MAIN = {"CL": "alpha", "CD": "alpha", "Cm": "alpha", "CY": "beta", "Cl": "beta", "Cn": "beta"}
MOTION = {"V": 0.03, "alpha": 0.05, "alpha2": 0.005, "beta": 0.05, "beta2": 0.0025, "q": 0.004, "abs_elevator": 0.03}


def _added(sim: Simulator, plan: Plan, trim: dict) -> dict:
    """The values of the added terms: they make the given part of what 0.05 rad of the main variable does, less what they do
    in the trim, which a constant takes up."""
    values = {}
    for name, part in plan.added.items():
        coefficient, variable = name.split("_", 1)
        main = sim.derivative(trim, coefficient, MAIN[coefficient])
        values[name] = part * main * 0.05 / MOTION[variable]
        at_trim = {"V": 1.0, "alpha": trim["alpha"], "alpha2": trim["alpha"] ** 2, "abs_elevator": abs(trim["elevator"])}
        values[f"{coefficient}_0"] = values.get(f"{coefficient}_0", 0.0) - values[name] * at_trim.get(variable, 0.0)
    return values


def _commands(time, plan: Plan, m: dict, speed: float, rng) -> dict:
    """Commands to the three surfaces, from the trim."""
    frequency = math.sqrt(max(-m["M_alpha"], 0.8))
    unit = {
        "elevator": min(max(1.6 / frequency, 0.35), 1.5),
        "aileron": 1.0,
        "rudder": min(max(2.0 / math.sqrt(max(m["N_beta"], 0.5)), 0.5), 2.0),
    }
    degree = math.pi / 180
    size = {
        # About three degrees of angle of attack, fifteen degrees per second of roll, three degrees of sideslip.
        "elevator": min(max(3 * degree * max(-m["M_alpha"], 1.0) / abs(m["M_elevator"]), 0.7 * degree), 5 * degree),
        "aileron": min(max(15 * degree * abs(m["L_p"] / m["L_aileron"]), 1.0 * degree), 8 * degree),
        "rudder": min(max(3 * degree * abs(m["N_beta"] / m["N_rudder"]), 1.0 * degree), 8 * degree),
    }
    commands = {name: np.zeros(len(time)) for name in size}
    for pattern, surface, start, factor, *rest in plan.manoeuvres:
        amplitude = size[surface] * factor * rng.uniform(0.85, 1.15)
        if pattern == "stick":
            commands[surface] += inputs.stick(time, start, rest[0], 0.5 / unit[surface] ** 0.5, amplitude * 1.3, rng)
        elif pattern == "sweep":
            commands[surface] += inputs.sweep(time, start, rest[0], 1.0 / unit[surface], amplitude)
        elif pattern == "multisine":
            commands[surface] += inputs.multisine(time, start, rest[0], 1.0 / unit[surface], amplitude * 1.3, surface)
        elif pattern == "waves":
            commands[surface] += inputs.waves(time, start, rest[0], amplitude)
        else:
            sign = -1 if rng.random() < 0.5 else 1
            start = start + rng.uniform(-0.3, 0.3)
            commands[surface] += inputs.steps(time, start, unit[surface] * rng.uniform(0.9, 1.1), inputs.PATTERNS[pattern], sign * amplitude)
    for when, change, takes in plan.retrims:
        commands["elevator"] += size["elevator"] * change * np.clip((time - when) / takes, 0, 1)
    return commands


def _to_earth(gust, phi, theta, psi):
    """From body axes to north, east, down."""
    u, v, w = gust
    sf, cf, st, ct, sp, cp = math.sin(phi), math.cos(phi), math.sin(theta), math.cos(theta), math.sin(psi), math.cos(psi)
    x, y, z = u * ct + (v * sf + w * cf) * st, v * cf - w * sf, -u * st + (v * sf + w * cf) * ct
    return x * cp - y * sp, x * sp + y * cp, z


def _row(sim: Simulator) -> tuple:
    get = sim.get
    return (
        get("velocities/vt-fps") * FT,
        get("aero/alpha-rad"),
        get("aero/beta-rad"),
        get("attitude/phi-rad"),
        get("attitude/theta-rad"),
        get("velocities/p-rad_sec"),
        get("velocities/q-rad_sec"),
        get("velocities/r-rad_sec"),
        *sim.specific_force(),
        get("position/h-sl-ft") * FT,
        get("atmosphere/rho-slugs_ft3") * RHO,
        get("aero/qbar-psf") * PSF,
        sim.thrust,
        sim.surfaces["elevator"],
        sim.surfaces["aileron"],
        sim.surfaces["rudder"],
        # Relative to the air, which turbulence turns: what the aerodynamics see.
        get("velocities/p-aero-rad_sec"),
        get("velocities/q-aero-rad_sec"),
        get("velocities/r-aero-rad_sec"),
    )
