"""Which flights there are: conditions, manoeuvres, instruments, damage; by aircraft and by seed."""

import zlib

from aircraft import Aircraft
from fly import Plan

# Which repetition of an aircraft's flights belongs to which part. Repetitions differ in condition, times, sizes, gusts, noise.
REPETITIONS = {"develop": (1,), "look-once": (101,)}

# The same of the flights with a flight control system (`--feedback`), and who flies them.
FEEDBACK_REPETITIONS = {"develop": (1, 2, 3, 4), "look-once": (101,)}
FEEDBACK_AIRCRAFT = ("T38", "f15", "fokker100", "pc7", "t6texan2", "p51d", "T37", "global5000", "A320")

# What is kept in the project, for the checks that always run: by aircraft, names of flights of the part `develop`.
SAMPLE = {"OV10": ("calm-short", "damage-elevator"), "pc7": ("light-stick",), "T38": ("lat-light-stick",)}
# The same of the flights of whole aircraft (`--whole`).
WHOLE_SAMPLE = {"pc7": ("whole-light-3211",)}


def _longitudinal() -> list[dict]:
    three = (("3211", "elevator", 4, 1.0), ("doublet", "elevator", 18, 1.0))
    doublets = (("doublet", "elevator", 3, 1.0), ("doublet", "elevator", 11, 0.7), ("2311", "elevator", 19, 0.8))
    stick = (("stick", "elevator", 2, 1.0, 28),)
    rough = {"outliers": 0.005, "missing": 0.02, "lost_rows": 0.01, "gaps": ((15.0, 16.6),)}
    busy = (("3211", "elevator", 3, 1.0), ("stick", "elevator", 14, 0.8, 24), ("doublet", "elevator", 33, 1.0), ("3211", "elevator", 42, 0.9))
    return [
        dict(name="calm-3211", group="calm", manoeuvres=three),
        dict(name="calm-doublets", group="calm", manoeuvres=doublets, rate_hz=100),
        dict(name="calm-short", group="calm", manoeuvres=(("3211", "elevator", 2, 1.0),), duration=12.0),
        dict(name="calm-stick-damper", group="closed loop", manoeuvres=stick, loop="damper"),
        dict(name="calm-3211-attitude", group="closed loop", manoeuvres=three, loop="attitude"),
        dict(name="light-3211", group="light turbulence", manoeuvres=three, gust=0.8),
        dict(name="light-stick", group="light turbulence", manoeuvres=stick, gust=0.8, rate_hz=25),
        dict(name="light-doublets-damper", group="light turbulence", manoeuvres=doublets, gust=0.8, loop="damper"),
        dict(name="moderate-doublets", group="moderate turbulence", manoeuvres=doublets, gust=1.8, loop="attitude"),
        dict(name="moderate-3211", group="moderate turbulence", manoeuvres=three, gust=1.8, rate_hz=100),
        dict(name="filtered-3211", group="common filter", manoeuvres=three, instruments={"common_lag": 0.025}, rate_hz=100),
        dict(name="filtered-light", group="common filter", manoeuvres=doublets, gust=0.8, instruments={"common_lag": 0.04}),
        dict(name="rough-records", group="outliers and gaps", manoeuvres=three, instruments=rough),
        dict(name="rough-light", group="outliers and gaps", manoeuvres=doublets, gust=0.8, instruments=rough),
        # Potentiometers of a tenth of a degree and more: the noise of a known input, which few estimators allow for.
        dict(name="noisy-surface", group="noisy surface", manoeuvres=three, instruments={"noise_of": {"elevator": 4.0}}),
        dict(name="retrim", group="retrim", manoeuvres=(("3211", "elevator", 4, 1.0), ("doublet", "elevator", 32, 1.0), ("3211", "elevator", 48, 0.8)),
             retrims=((18.0, 0.35, 3.0),), loop="damper", duration=60.0),
        dict(name="throttle", group="retrim", manoeuvres=(("3211", "elevator", 4, 1.0), ("doublet", "elevator", 28, 1.0)), thrust=((16.0, 0.5),),
             loop="damper", duration=40.0),
        dict(name="quiet-first", group="long quiet", manoeuvres=(("3211", "elevator", 32, 1.0),), duration=45.0, gust=0.4, loop="damper"),
        dict(name="own-lags", group="own lags", kind="faulty", manoeuvres=three,
             instruments={"lags": {"tas": 0.25, "qbar": 0.25, "alpha": 0.04, "altitude": 0.25, "theta": 0.02, "q": 0.008, "ax": 0.008, "az": 0.008, "elevator": 0.02}}),
        dict(name="damage-cm-alpha", group="damage", manoeuvres=busy, duration=55.0, damage=(28.0, {"Cm_alpha": -0.5}), loop="damper"),
        dict(name="damage-elevator", group="damage", manoeuvres=busy, duration=55.0, damage=(28.0, {"Cm_elevator": -0.5}), gust=0.4, loop="attitude"),
        dict(name="damage-cl-alpha", group="damage", manoeuvres=busy, duration=55.0, damage=(28.0, {"CL_alpha": -0.25}), loop="attitude"),
        dict(name="damage-cm-q", group="damage", manoeuvres=busy, duration=55.0, damage=(28.0, {"Cm_q": -0.6}), loop="damper"),
        dict(name="damage-tail", group="damage", manoeuvres=busy, duration=55.0, damage=(28.0, {"Cm_elevator": -0.4, "Cm_q": -0.4, "Cm_alpha": -0.3}), gust=0.8,
             loop="attitude"),
        dict(name="trim-shift", group="trim shift", manoeuvres=busy, duration=55.0, damage=(28.0, {"Cm_0": 0.015}), loop="attitude"),
        dict(name="trim-shift-light", group="trim shift", manoeuvres=busy, duration=55.0, damage=(28.0, {"Cm_0": -0.015}), gust=0.8, loop="damper"),
        dict(name="long-smooth", group="long healthy", duration=240.0, loop="attitude", gust=0.2, rate_hz=25, manoeuvres=_every(240, 22)),
        dict(name="long-light", group="long healthy", duration=240.0, loop="attitude", gust=0.8, manoeuvres=_every(240, 30)),
    ]


def _every(duration: float, period: float) -> tuple:
    """A manoeuvre every `period` seconds, in turn; between them nothing is asked."""
    kinds = ("3211", "doublet", "stick", "2311")
    out = []
    for k in range(int((duration - 15) / period)):
        start = 5.0 + k * period
        kind = kinds[k % 4]
        out.append((kind, "elevator", start, 0.8, start + 9.0) if kind == "stick" else (kind, "elevator", start, 0.8))
    return tuple(out)


def _lateral() -> list[dict]:
    doublets = (("doublet", "aileron", 3, 1.0), ("doublet", "rudder", 9, 1.0), ("doublet", "aileron", 17, 0.8), ("3211", "rudder", 21, 0.6))
    stick = (("stick", "aileron", 2, 0.9, 27), ("stick", "rudder", 3, 0.8, 28))
    busy = (("doublet", "aileron", 3, 1.0), ("doublet", "rudder", 8, 1.0), ("stick", "aileron", 15, 0.7, 25), ("stick", "rudder", 15, 0.6, 25),
            ("doublet", "rudder", 31, 1.0), ("doublet", "aileron", 38, 1.0), ("3211", "rudder", 44, 0.6))
    rough = {"outliers": 0.005, "missing": 0.02, "lost_rows": 0.01, "gaps": ((14.0, 15.6),)}
    return [
        dict(name="lat-calm", group="calm", manoeuvres=doublets),
        dict(name="lat-stick-damper", group="closed loop", manoeuvres=stick, loop="damper"),
        dict(name="lat-attitude", group="closed loop", manoeuvres=doublets, loop="attitude", rate_hz=100),
        dict(name="lat-light", group="light turbulence", manoeuvres=doublets, gust=0.8, loop="attitude"),
        dict(name="lat-light-stick", group="light turbulence", manoeuvres=stick, gust=0.8, loop="damper", rate_hz=25),
        dict(name="lat-moderate", group="moderate turbulence", manoeuvres=doublets, gust=1.8, loop="attitude"),
        dict(name="lat-filtered", group="common filter", manoeuvres=doublets, loop="damper", instruments={"common_lag": 0.025}, rate_hz=100),
        dict(name="lat-rough", group="outliers and gaps", manoeuvres=doublets, loop="damper", instruments=rough),
        dict(name="lat-damage-aileron", group="damage", manoeuvres=busy, duration=52.0, damage=(27.0, {"Cl_aileron": -0.5}), loop="attitude"),
        dict(name="lat-damage-fin", group="damage", manoeuvres=busy, duration=52.0, damage=(27.0, {"Cn_beta": -0.4, "Cn_rudder": -0.4}), loop="attitude", gust=0.4),
    ]


# Every channel of every instrument, for a recorder that is better or worse as a whole.
def _noise(factor: float) -> dict:
    channels = ("tas", "alpha", "beta", "phi", "theta", "p", "q", "r", "ax", "ay", "az", "elevator", "aileron", "rudder")
    return {"noise_of": {channel: factor for channel in channels}}


def _feedback() -> list[dict]:
    """A stabilised aircraft: feedback moves the surfaces with the motion, and one axis is excited before the other."""
    rudder_first = (("doublet", "rudder", 3, 1.5), ("doublet", "aileron", 8, 1.5), ("3211", "rudder", 14, 1.0), ("doublet", "aileron", 21, 1.5))
    # The rudder alone for long: everything is believed to be known when the ailerons first move.
    rudder_long = (("doublet", "rudder", 3, 1.5), ("3211", "rudder", 9, 1.2), ("doublet", "aileron", 20, 1.5), ("doublet", "aileron", 25, 1.2))
    hands = (("doublet", "rudder", 3, 1.5), ("stick", "aileron", 9, 1.2, 28), ("stick", "rudder", 14, 1.0, 28))
    pitch = (("doublet", "elevator", 3, 1.5), ("3211", "elevator", 10, 1.5), ("doublet", "elevator", 20, 1.5))
    lateral = [
        dict(name="rudder-first", group="calm", manoeuvres=rudder_first),
        dict(name="rudder-long", group="calm", manoeuvres=rudder_long, duration=32.0),
        dict(name="rudder-stick", group="calm", manoeuvres=hands),
        dict(name="rudder-good", group="good instruments", manoeuvres=rudder_first, instruments=_noise(0.3), rate_hz=100),
        dict(name="rudder-poor", group="poor instruments", manoeuvres=rudder_first, instruments=_noise(3.0)),
        dict(name="rudder-light", group="light turbulence", manoeuvres=rudder_long, gust=0.5, duration=32.0),
    ]
    longitudinal = [
        dict(name="pitch", group="calm", manoeuvres=pitch),
        dict(name="pitch-good", group="good instruments", manoeuvres=pitch, instruments=_noise(0.3), rate_hz=100),
        dict(name="pitch-poor", group="poor instruments", manoeuvres=pitch, instruments=_noise(3.0)),
        dict(name="pitch-light", group="light turbulence", manoeuvres=pitch, gust=0.5),
    ]
    return [dict(axes="lateral", **one) for one in lateral] + [dict(axes="longitudinal", **one) for one in longitudinal]


def feedback_flights(spec: Aircraft, split: str, repetition: int | None = None) -> list[Plan]:
    """The flights of one stabilised aircraft in one part, or in another repetition of it."""
    if spec.name not in FEEDBACK_AIRCRAFT or split == "develop" and spec.look_once_only:
        return []
    out = []
    for k in FEEDBACK_REPETITIONS[split] if repetition is None else (repetition,):
        for one in _feedback():
            seed = zlib.crc32(f"{spec.name}/feedback/{one['name']}/{k}".encode())
            plan = Plan(seed=seed, loop="stabilised", **one)
            plan.name += f"-{k}"
            out.append(plan)
    return out


def _quiet() -> list[dict]:
    """Flights in which nobody moves a stick: air, control loops, instruments, a re-trim and a change of thrust."""
    poor = _noise(3.0)
    air = (("calm", 0.0), ("light", 0.8), ("moderate", 1.8))
    loops = [dict(name=f"{name}-{loop}", group=f"{name} air", gust=gust, loop=loop) for name, gust in air for loop in ("open", "damper", "attitude")]
    return loops + [
        dict(name="light-attitude-25", group="light air", gust=0.8, loop="attitude", rate_hz=25),
        dict(name="light-attitude-100", group="light air", gust=0.8, loop="attitude", rate_hz=100),
        dict(name="poor-attitude", group="poor instruments", gust=0.8, loop="attitude", instruments=poor),
        dict(name="poor-open", group="poor instruments", gust=0.0, loop="open", instruments=poor),
        dict(name="filtered-attitude", group="common filter", gust=0.8, loop="attitude", instruments={"common_lag": 0.025}, rate_hz=100),
        dict(name="thrust-attitude", group="change of thrust", gust=0.4, loop="attitude", thrust=((12.0, 0.7),)),
    ]


def quiet_flights(spec: Aircraft, split: str, repetition: int | None = None) -> list[Plan]:
    """Flights of one aircraft without any manoeuvre, to count what is found where nothing is."""
    quiet = [one | {"name": f"quiet-{one['name']}"} for one in _quiet()]
    named = [(axes, [one | {"name": f"{prefix}{one['name']}"} for one in quiet]) for axes, prefix in (("longitudinal", ""), ("lateral", "lat-"))]
    return _planned(spec, split, repetition, named)


# Terms that an aircraft has beside those of its model file, with the part of the coefficient's motion that they make.
ADDED = {
    "longitudinal": ({}, {"Cm_V": 0.15}, {"Cm_alpha2": 0.15}, {"CL_alpha2": 0.08}, {"CD_abs_elevator": 0.4}, {"Cm_abs_elevator": 0.15}),
    "six": ({}, {"Cm_beta2": 0.15}, {"CD_beta2": 0.4}, {"Cm_beta": 0.1}, {"Cn_alpha": 0.1}, {"Cl_q": 0.1}),
}


def _structure(axes: str) -> list[dict]:
    """Flights in calm air, light turbulence and through a common filter, with each of the added terms."""
    elevator = (("3211", "elevator", 3, 1.0), ("doublet", "elevator", 17, 1.0), ("2311", "elevator", 27, 0.8))
    surfaces = (("doublet", "aileron", 3, 0.6), ("3211", "elevator", 7, 1.0), ("3211", "rudder", 16, 1.0), ("doublet", "elevator", 26, 1.0), ("doublet", "rudder", 31, 1.0))
    both = axes == "six"
    common = dict(duration=38.0, manoeuvres=surfaces if both else elevator, loop="attitude", thrust=() if both else ((13.0, 0.7),))
    out = []
    for added in ADDED[axes]:
        name = "-".join(added).lower().replace("_", "-") or "nothing"
        for air, more in (("calm", {}), ("light", {"gust": 0.8}), ("filtered", {"gust": 0.3, "instruments": {"common_lag": 0.025}, "rate_hz": 100})):
            out.append(dict(name=f"st-{axes}-{name}-{air}", group=f"{name} {air}", added=added, **common, **more))
    return out


def structure_flights(spec: Aircraft, split: str, repetition: int | None = None) -> list[Plan]:
    """Flights of one aircraft with terms that no model file has."""
    lists = [("longitudinal", _structure("longitudinal"))]
    if "lat-" not in spec.left_out:
        lists.append(("six", _structure("six")))
    return _planned(spec, split, repetition, lists)


def _other() -> list[tuple[str, list[dict]]]:
    """Flights with inputs that the field has not: sweeps, multisines, slow waves, bank to bank, turns, all surfaces at once,
    one short pulse alone, a record that begins within a manoeuvre, and a large change of speed."""
    surfaces = ("elevator", "aileron", "rudder")
    longitudinal = [
        dict(name="sweep", group="sweep", duration=32.0, manoeuvres=(("sweep", "elevator", 3, 0.8, 29),), loop="damper"),
        dict(name="sweep-light", group="sweep", duration=32.0, manoeuvres=(("sweep", "elevator", 3, 0.8, 29),), loop="damper", gust=0.8),
        dict(name="multisine", group="multisine", duration=26.0, manoeuvres=(("multisine", "elevator", 3, 1.0, 23),)),
        dict(name="multisine-light", group="multisine", duration=26.0, manoeuvres=(("multisine", "elevator", 3, 1.0, 23),), gust=0.8, rate_hz=25),
        dict(name="waves", group="slow waves", duration=32.0, manoeuvres=(("waves", "elevator", 3, 0.8, 17), ("doublet", "elevator", 22, 1.0))),
        dict(name="waves-alone", group="slow waves", duration=20.0, manoeuvres=(("waves", "elevator", 3, 0.8, 17),), gust=0.4),
        dict(name="pulse", group="one pulse", duration=12.0, manoeuvres=(("pulse", "elevator", 4, 1.0),)),
        dict(name="within", group="begins within", duration=20.0, manoeuvres=(("3211", "elevator", -1, 1.0),), gust=0.4),
        dict(name="faster", group="other speed", duration=50.0, thrust=((5.0, 1.8),), loop="attitude",
             manoeuvres=(("doublet", "elevator", 9, 1.0), ("3211", "elevator", 24, 0.8), ("doublet", "elevator", 40, 0.8))),
    ]
    lateral = [
        dict(name="lat-bank", group="bank to bank", duration=32.0, loop="damper",
             manoeuvres=(("to-and-fro", "aileron", 3, 2.2), ("doublet", "rudder", 11, 1.0), ("to-and-fro", "aileron", 18, 1.5), ("doublet", "rudder", 25, 0.8))),
        dict(name="lat-multisine", group="multisine", duration=28.0, loop="attitude", manoeuvres=tuple(("multisine", s, 3, 1.2, 25) for s in surfaces[1:])),
        dict(name="lat-sweep", group="sweep", duration=44.0, loop="attitude", gust=0.4,
             manoeuvres=(("sweep", "aileron", 3, 1.0, 22), ("sweep", "rudder", 23, 0.8, 42))),
    ]
    turn = (("pulse", "aileron", 3, 2.2), ("doublet", "elevator", 7, 0.8), ("doublet", "rudder", 11, 0.8), ("3211", "elevator", 15, 0.7), ("doublet", "aileron", 23, 1.0))
    six = [
        dict(name="lat-six-multisine", group="all at once", duration=28.0, loop="attitude", manoeuvres=tuple(("multisine", s, 3, 1.0, 25) for s in surfaces)),
        dict(name="lat-six-multisine-light", group="all at once", duration=28.0, loop="attitude", gust=0.8, manoeuvres=tuple(("multisine", s, 3, 1.0, 25) for s in surfaces)),
        dict(name="lat-six-stick", group="all at once", loop="damper", gust=0.8, manoeuvres=tuple(("stick", s, 2 + k, 0.9, 28) for k, s in enumerate(surfaces))),
        dict(name="lat-six-turn", group="turn", duration=30.0, loop="damper", manoeuvres=turn),
    ]
    return [("longitudinal", longitudinal), ("lateral", lateral), ("six", six)]


def other_flights(spec: Aircraft, split: str, repetition: int | None = None) -> list[Plan]:
    """Flights of one aircraft with inputs that the field has not."""
    named = [(axes, [one | {"name": one["name"].replace("lat-", "lat-other-") if one["name"].startswith("lat-") else f"other-{one['name']}"} for one in list_]) for axes, list_ in _other()]
    return _planned(spec, split, repetition, named)


def flights(spec: Aircraft, split: str, repetition: int | None = None) -> list[Plan]:
    """The flights of one aircraft in one part of the field, or in another repetition of it."""
    return _planned(spec, split, repetition, (("longitudinal", _longitudinal()), ("lateral", _lateral())))


def gliding_flights(spec: Aircraft, split: str, repetition: int | None = None) -> list[Plan]:
    """The flights of one aircraft without thrust, but for those that change it."""
    kinds = [(axes, [one for one in list_ if "thrust" not in one]) for axes, list_ in (("longitudinal", _longitudinal()), ("lateral", _lateral()))]
    plans = _planned(spec, split, repetition, kinds)
    for plan in plans:
        plan.gliding = True
        plan.seed = zlib.crc32(f"{spec.name}/gliding/{plan.name}/{plan.seed}".encode())
        plan.name = f"glide-{plan.name}"
    return plans


# Aircraft whose propellers are driven with constant power.
PROPELLERS = ("c182", "c310", "pc7", "OV10", "DHC6", "t6texan2", "p51d", "C130", "L17", "J3Cub", "pa28", "fokker50", "B17", "L410", "Boeing314", "dr1")


def propeller_flights(spec: Aircraft, split: str, repetition: int | None = None) -> list[Plan]:
    """The flights of one aircraft with a thrust that falls with the airspeed (a propeller's as its reciprocal, a jet's as the root of
    that), along a line up to a fifth of the chord above or below the centre of gravity. No recorder has it."""
    plans = gliding_flights(spec, split, repetition)
    for plan in plans:
        plan.gliding = False
        plan.name = plan.name.replace("glide-", "propeller-")
        plan.seed = zlib.crc32(f"{spec.name}/propeller/{plan.name}/{plan.seed}".encode())
        below = (zlib.crc32(f"{spec.name}/thrust line".encode()) % 1000 / 1000 - 0.5) * 0.4
        plan.propeller = (1.0 if spec.name in PROPELLERS else 0.5, below)
    return plans


# Aircraft that come to steady flight with everything that their descriptions have. The others read what only another program gives them, have no
# engine that starts in the air, or their controls do not answer.
WHOLE = ("c182", "c310", "pc7", "OV10", "DHC6", "T38", "f15", "t6texan2", "T37", "global5000", "J3Cub", "A4", "B747", "F80C", "MD11", "F4N", "787-8")


def whole_flights(spec: Aircraft, split: str, repetition: int | None = None) -> list[Plan]:
    """The flights of one aircraft without damage, with the engines and controls of its own description. No recorder has the thrust."""
    if spec.name not in WHOLE:
        return []
    plans = _without_damage(spec, split, repetition)
    for plan in plans:
        plan.whole = True
        plan.seed = zlib.crc32(f"{spec.name}/whole/{plan.name}/{plan.seed}".encode())
        plan.name = f"whole-{plan.name}"
    return plans


def large_flights(spec: Aircraft, split: str, repetition: int | None = None) -> list[Plan]:
    """The flights of one aircraft without damage, with inputs two and a half times as large: tables bend there, and angles are not small."""
    plans = _without_damage(spec, split, repetition)
    for plan in plans:
        plan.manoeuvres = tuple((pattern, surface, start, 2.5 * factor, *rest) for pattern, surface, start, factor, *rest in plan.manoeuvres)
        plan.seed = zlib.crc32(f"{spec.name}/large/{plan.name}/{plan.seed}".encode())
        plan.name = f"large-{plan.name}"
    return plans


def turning_flights(spec: Aircraft, split: str, repetition: int | None = None) -> list[Plan]:
    """The flights of one aircraft without damage, in the turbulence of JSBSim itself, which turns the air as well: light, and moderate
    where the field has moderate gusts."""
    plans = _without_damage(spec, split, repetition)
    for plan in plans:
        plan.turning = (25.0, 3) if plan.gust > 1 else (15.0, 2)
        plan.group = f"turning air, {'moderate' if plan.gust > 1 else 'light'}"
        plan.gust = 0.0
        plan.seed = zlib.crc32(f"{spec.name}/turning/{plan.name}/{plan.seed}".encode())
        plan.name = f"turning-{plan.name}"
    return plans


def _without_damage(spec: Aircraft, split: str, repetition: int | None) -> list[Plan]:
    kinds = [(axes, [one for one in list_ if "damage" not in one]) for axes, list_ in (("longitudinal", _longitudinal()), ("lateral", _lateral()))]
    return _planned(spec, split, repetition, kinds)


def _planned(spec: Aircraft, split: str, repetition: int | None, lists) -> list[Plan]:
    if split == "develop" and spec.look_once_only:
        return []
    out = []
    for repetition in REPETITIONS[split] if repetition is None else (repetition,):
        for axes, list_ in lists:
            for one in list_:
                # The same on every machine: Python's own hash of a text is not.
                seed = zlib.crc32(f"{spec.name}/{axes}/{one['name']}/{repetition}".encode())
                plan = Plan(axes=axes, seed=seed, **one)
                if repetition not in (1, 101):
                    plan.name += f"-{repetition}"
                out.append(plan)
    return out
