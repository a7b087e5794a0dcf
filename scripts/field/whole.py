"""One JSBSim aircraft as it ships: with its own engines, propellers, tanks and flight control system.

Nothing of its description is left out. A hand on every control brings it to steady flight, from where the flight begins; the
manoeuvres are then commands to its flight control system, and what is recorded are the surfaces behind that. What its engines do beside
their thrust (the torque of a propeller, the line that they pull along, the air that they blow over the tail) is in its motion.
"""

import math

import jsbsim
import numpy as np

from simulator import FT, LBF, SLUG, Simulator

SURFACES = ("elevator", "aileron", "rudder")
# Time that the hand on the controls has to come to steady flight, and that of its end over which the trim is taken, s.
SETTLING, TAKEN = 120.0, 6.0
# Part of a full command by which, and time after which (s), the way of a surface is measured.
SMALL, SHORT = 0.2, 0.4


class Whole(Simulator):
    """An aircraft with everything that its description has. `bare` is the same without engines and controls: its trim and its response
    are where the hand begins."""

    def __init__(self, bare: Simulator):
        self.bare, self.spec, self.step_s = bare, bare.spec, bare.step_s
        self.fdm = jsbsim.FGFDMExec(None)
        self.fdm.set_debug_level(0)
        # Some descriptions write files.
        self.fdm.set_output_path(str(bare.folder))
        if not self.fdm.load_model(self.spec.name, True):
            raise RuntimeError(f"{self.spec.name}: JSBSim does not load its description")
        self._prepare()
        self._engines = 0
        while self._manager.get_node(f"propulsion/engine[{self._engines}]/set-running") is not None:
            self._engines += 1
        # Of the command of each surface, rad.
        self._way = dict.fromkeys(SURFACES, 0.0)
        self._settled: dict[str, float] = {}

    def _start_engines(self) -> None:
        fdm = self.fdm
        fdm["propulsion/set-running"] = -1
        fdm["propulsion/magneto_cmd"] = 3
        for k in range(self._engines):
            fdm[f"fcs/mixture-cmd-norm[{k}]"] = 0.9
            fdm[f"fcs/advance-cmd-norm[{k}]"] = 0.9
        for name in ("gear/gear-cmd-norm", "gear/gear-pos-norm", "fcs/flap-cmd-norm"):
            fdm[name] = 0.0
        self._set_throttle(0.6)

    def _set_throttle(self, part: float) -> None:
        for k in range(self._engines):
            self.fdm[f"fcs/throttle-cmd-norm[{k}]"] = min(max(part, 0.0), 1.0)

    def _command(self, **parts: float) -> None:
        for name, part in parts.items():
            self.set(f"fcs/{name}-cmd-norm", min(max(part, -1.0), 1.0))

    def positions(self) -> dict[str, float]:
        """Surfaces (rad) with the signs of Phugoid, behind the flight control system."""
        spec = self.spec
        full = spec.full_deflections or (1.0, 1.0, 1.0)
        what = "norm" if spec.full_deflections else "rad"
        names = (f"elevator-pos-{what}", f"left-aileron-pos-{what}", f"rudder-pos-{what}")
        return {s: self.get(f"fcs/{n}") * f * sign for s, n, f, sign in zip(SURFACES, names, full, spec.signs)}

    def _begin_at(self, trim: dict[str, float]) -> None:
        self._start_engines()
        self._command(elevator=0.0, aileron=0.0, rudder=0.0)
        self.start(trim["speed"], trim["altitude"], trim["alpha"])
        self._start_engines()

    def _way_of(self, surface: str, trim: dict[str, float]) -> float:
        """How far a whole command moves a surface, rad."""
        seen = []
        for sign in (1, -1):
            self._begin_at(trim)
            self._command(**{surface: SMALL * sign})
            for _ in range(int(SHORT / self.step_s)):
                self.step()
            seen.append(self.positions()[surface])
        way = (seen[0] - seen[1]) / (2 * SMALL)
        if abs(way) < 0.02:
            raise RuntimeError(f"{self.spec.name}: its command does not move the {surface}")
        return way

    def trim(self, speed: float, altitude: float, gliding: bool = False, below: float = 0.0) -> dict[str, float]:
        """Flies until everything stands still. The hand holds speed, altitude, wings and ball."""
        if self._engines == 0:
            raise RuntimeError(f"{self.spec.name}: no engine")
        bare = self.bare.trim(speed, altitude)
        self._response = m = self.bare.response(bare)
        self._way = {surface: self._way_of(surface, bare) for surface in SURFACES}
        self._begin_at(bare)
        get, step = self.get, self.step_s
        attitude = max(1.0, -0.4 * m["M_alpha"]) / abs(m["M_elevator"])
        bank, roll = max(0.6, -0.7 * m["L_p"]) / abs(m["L_aileron"]), 0.8 / abs(m["L_aileron"])
        ball, yaw = max(m["N_beta"], 0.3) / abs(m["N_rudder"]), 0.4 / abs(m["N_rudder"])
        elevator = aileron = rudder = 0.0
        throttle, wanted = 0.6, bare["alpha"]
        last = []
        count = int(SETTLING / step)
        for k in range(count):
            v, h, climb = (get(name) * FT for name in ("velocities/vt-fps", "position/h-sl-ft", "velocities/h-dot-fps"))
            phi, theta, beta = get("attitude/phi-rad"), get("attitude/theta-rad"), get("aero/beta-rad")
            p, q, r = (get(f"velocities/{axis}-rad_sec") for axis in "pqr")
            slow = (speed - v) / speed
            steep = (min(max(0.05 * (altitude - h), -3.0), 3.0) - climb) / v
            throttle = min(max(throttle + step * 0.06 * slow, 0.02), 1.0)
            wanted = min(max(wanted + step * 0.15 * steep, bare["alpha"] - 0.15), bare["alpha"] + 0.15)
            error = theta - wanted - 0.5 * steep
            elevator += step * 0.4 * attitude * error
            aileron += step * 0.1 * bank * phi
            rudder -= step * 0.15 * ball * beta
            asked = (elevator + attitude * (q + error), aileron + bank * phi + roll * p, rudder + yaw * r)
            self.follow(asked)
            part = throttle + 2.5 * slow
            self._set_throttle(part)
            self.step()
            if abs(phi) > 1.3 or abs(theta) > 0.9 or not math.isfinite(q):
                raise RuntimeError(f"{self.spec.name}: it does not come to level flight at {speed:.0f} m/s")
            if k >= count - int(TAKEN / step):
                last.append((*asked, get("aero/alpha-rad"), theta, phi, v, h, part, self.thrust))
        names = (*SURFACES, "alpha", "theta", "phi", "speed", "altitude", "throttle", "thrust")
        trim = dict(zip(names, map(float, np.mean(last, axis=0))))
        moves = float(np.std([row[4] for row in last]))
        if moves > 0.002 or trim["throttle"] > 0.99 or abs(trim["speed"] / speed - 1) > 0.05:
            raise RuntimeError(f"{self.spec.name}: no steady flight at {speed:.0f} m/s, {altitude:.0f} m")
        self._settled = trim
        self.trim_speed = trim["speed"]
        return trim | {"climb": 0.0, "residual": 0.0}

    def response(self, trim: dict[str, float]) -> dict[str, float]:
        return self._response

    def begin(self, trim: dict[str, float], below: float = 0.0) -> None:
        """It flies already. The air begins to move with the record."""
        self.set_thrust(trim["thrust"])

    def follow(self, asked: tuple[float, float, float]) -> None:
        """Commands to the flight control system that would bring the surfaces (rad) there in steady flight."""
        self._command(**{name: angle / self._way[name] for name, angle in zip(SURFACES, asked)})
        self.surfaces = self.positions()

    def set_thrust(self, newton: float) -> None:
        """The lever, as far from that of the trim as this thrust is."""
        self._set_throttle(self._settled["throttle"] * newton / self._settled["thrust"])

    @property
    def thrust(self) -> float:
        return self.get("forces/fbx-prop-lbs") * LBF

    def specific_force(self) -> tuple[float, float, float]:
        mass = self.get("inertia/mass-slugs")
        return tuple(self.get(f"forces/fb{axis}-total-lbs") / mass * FT for axis in "xyz")
