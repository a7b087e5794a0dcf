"""Which aircraft of JSBSim fly the field, where, and with which instruments.

Not among them: c172p, 737, f16, SGS, minisgs, Concorde. They are kept for a check that nothing here has seen.
"""

from dataclasses import dataclass, field

# One sigma as data sheets of three classes of instruments give it: m/s, rad, rad/s, m/s2, m. A flight
# may have all of them, or one, a number of times as large.
DEGREE = 0.017453292519943295
TEST = dict(tas=0.15, vane=0.05 * DEGREE, attitude=0.05 * DEGREE, rate=0.02 * DEGREE, acceleration=0.02, surface=0.01 * DEGREE, altitude=0.5)
AIRLINER = dict(tas=0.3, vane=0.1 * DEGREE, attitude=0.1 * DEGREE, rate=0.05 * DEGREE, acceleration=0.03, surface=0.02 * DEGREE, altitude=1.0)
LIGHT = dict(tas=0.5, vane=0.2 * DEGREE, attitude=0.2 * DEGREE, rate=0.15 * DEGREE, acceleration=0.06, surface=0.03 * DEGREE, altitude=1.5)


@dataclass(frozen=True)
class Aircraft:
    name: str
    # What it stands for.
    stands_for: str
    # True airspeed, m/s, and altitude, m.
    speed: float
    altitude: float
    # Fuel and load, fraction of the empty weight.
    load: float
    sheet: dict
    # How its recorder writes: "si", "degrees" or "us".
    units: str
    # "channel": air density recorded; "altitude": from the standard atmosphere.
    density: str
    # Its flights are all kept for the one look.
    look_once_only: bool = False
    # JSBSim's surfaces (elevator, left aileron, rudder) per one of Phugoid's.
    signs: tuple = (1, -1, 1)
    # Full deflections (rad) where the aerodynamics read normalised positions.
    full_deflections: tuple | None = None
    properties: dict = field(default_factory=lambda: {"gear/gear-pos-norm": 0.0})
    # Flights that it cannot fly: names that begin so.
    left_out: tuple = ()
    # Textbook values to start from, by its class: CL_alpha, Cm_alpha, Cm_q, Cm_elevator.
    guess: tuple = (5.0, -0.8, -12.0, -1.2)


FLEET = (
    Aircraft("c182", "light single", 60, 1500, 0.15, LIGHT, "us", "altitude"),
    Aircraft("c310", "light twin", 85, 2500, 0.25, LIGHT, "degrees", "altitude"),
    Aircraft("pc7", "turboprop trainer", 90, 3000, 0.10, TEST, "si", "channel"),
    Aircraft("OV10", "twin turboprop", 100, 2500, 0.20, AIRLINER, "us", "channel"),
    Aircraft("DHC6", "commuter twin", 75, 2000, 0.25, AIRLINER, "degrees", "altitude", left_out=("lat-", "long-")),
    Aircraft("T38", "jet trainer", 190, 5000, 0.25, TEST, "us", "altitude", full_deflections=(0.35, 0.44, 0.52), guess=(3.5, -0.6, -8.0, -1.0)),
    Aircraft("f15", "fighter", 210, 4500, 0.20, TEST, "degrees", "channel", guess=(3.5, -0.6, -8.0, -1.0)),
    Aircraft("fokker100", "jet transport", 200, 7600, 0.25, AIRLINER, "degrees", "altitude"),
    Aircraft("t6texan2", "turboprop trainer", 110, 3000, 0.15, TEST, "us", "altitude", look_once_only=True),
    Aircraft("p51d", "piston fighter", 130, 3000, 0.15, LIGHT, "degrees", "channel", look_once_only=True),
    Aircraft("T37", "jet trainer", 130, 4500, 0.20, TEST, "si", "altitude", look_once_only=True),
    Aircraft("global5000", "business jet", 210, 9000, 0.30, AIRLINER, "us", "altitude", look_once_only=True),
    Aircraft("A320", "jet transport", 210, 9000, 0.15, AIRLINER, "degrees", "channel", look_once_only=True),
)

# Aircraft that came later, as strangers: flown when asked for by name or with --strangers, in neither part of the field.
STRANGERS = (
    Aircraft("A4", "carrier attack jet", 180, 4000, 0.25, TEST, "degrees", "channel", look_once_only=True, guess=(3.5, -0.6, -8.0, -1.0)),
    Aircraft("B747", "heavy jet transport", 220, 9000, 0.15, AIRLINER, "us", "altitude", look_once_only=True),
    Aircraft("C130", "turboprop transport", 130, 4000, 0.20, AIRLINER, "degrees", "altitude", look_once_only=True),
    Aircraft("F80C", "early jet fighter", 170, 4000, 0.25, LIGHT, "us", "channel", look_once_only=True),
    Aircraft("L17", "light single, retractable", 65, 1500, 0.15, LIGHT, "degrees", "altitude", look_once_only=True),
    Aircraft("J3Cub", "light tail-dragger", 32, 800, 0.30, LIGHT, "us", "altitude", look_once_only=True),
    Aircraft("pa28", "light single", 58, 1500, 0.20, LIGHT, "si", "channel", look_once_only=True),
    Aircraft("fokker50", "regional turboprop", 125, 5000, 0.25, AIRLINER, "si", "altitude", look_once_only=True),
    Aircraft("f104", "interceptor", 230, 5000, 0.25, TEST, "us", "channel", look_once_only=True, guess=(3.5, -0.6, -8.0, -1.0)),
    Aircraft("MD11", "wide-body jet transport", 215, 9000, 0.15, AIRLINER, "degrees", "channel", look_once_only=True),
    Aircraft("F4N", "naval fighter", 220, 5000, 0.25, TEST, "si", "altitude", look_once_only=True, guess=(3.5, -0.6, -8.0, -1.0)),
    Aircraft("B17", "four-engined bomber", 85, 3000, 0.25, LIGHT, "degrees", "altitude", look_once_only=True),
    Aircraft("787-8", "jet transport", 215, 9000, 0.20, AIRLINER, "us", "channel", look_once_only=True),
)

# Aircraft of other kinds that came after them, in neither part of the field. Flown when asked for by name or with --newcomers.
# Not among them: XB-70, f22 and Camel (unstable without their control system), Shuttle (its trim is beyond the limits of the
# elevator here), Short_S23 (its description reads a file that does not come with it).
NEWCOMERS = (
    Aircraft("X15", "research aircraft", 220, 8000, 0.30, TEST, "si", "channel", look_once_only=True, guess=(3.5, -0.6, -8.0, -1.0)),
    Aircraft("L410", "commuter twin", 90, 2500, 0.20, AIRLINER, "degrees", "altitude", look_once_only=True),
    Aircraft("Boeing314", "flying boat", 75, 2000, 0.25, LIGHT, "degrees", "channel", look_once_only=True),
    Aircraft("dr1", "triplane", 42, 1000, 0.15, LIGHT, "us", "altitude", look_once_only=True, guess=(4.0, -0.5, -8.0, -1.0)),
    Aircraft("x24b", "lifting body", 180, 8000, 0.20, TEST, "si", "channel", look_once_only=True, guess=(1.5, -0.1, -1.0, -0.3)),
)
