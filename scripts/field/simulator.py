"""One JSBSim aircraft without engines, controls and systems: trim, step, read.

Written at run time from the description that ships with JSBSim: propulsion, autopilot, flight control and systems are
left out, the thrust is a force along body x through the centre of gravity, and each aerodynamic axis gets one more
function, which is zero until a flight asks for damage. The description itself is not copied into the project.

Signs are those of Phugoid: elevator and right aileron positive with the trailing edge down, rudder with the trailing
edge to the left. SI units outside, JSBSim's own (slug, foot, pound) inside.
"""

import math
import pathlib
import xml.etree.ElementTree as ET

import jsbsim
import numpy as np

FT = 0.3048
LBF = 4.4482216152605
SLUG = 14.593902937206
SLUG_FT2 = SLUG * FT * FT
PSF = LBF / FT / FT
RHO = SLUG / FT**3

# Bandwidth of the actuators, 1/s, and their limit, rad.
ACTUATOR, LIMIT = 20.0, 0.35

# Sections that are left out: they would write the surfaces and the thrust themselves.
LEFT_OUT = ("propulsion", "system", "autopilot", "flight_control", "external_reactions", "output", "input", "buoyant_forces")
# The functions that damage adds: axis of JSBSim, coefficient of Phugoid, sign, reference length.
DAMAGE = {
    "LIFT": ("CL", 1, None),
    "DRAG": ("CD", 1, None),
    "SIDE": ("CY", 1, None),
    "ROLL": ("Cl", 1, "metrics/bw-ft"),
    "PITCH": ("Cm", 1, "metrics/cbarw-ft"),
    "YAW": ("Cn", 1, "metrics/bw-ft"),
}
# Variables that a change of a derivative multiplies, as JSBSim has them; surfaces with the signs of Phugoid.
VARIABLES = ("0", "alpha", "beta", "p", "q", "r", "elevator", "aileron", "rudder")


def _description(name: str, payload: float) -> ET.ElementTree:
    """The aircraft's own description without the sections that are left out, with thrust and damage."""
    source = pathlib.Path(jsbsim.get_default_root_dir()) / "aircraft" / name / f"{name}.xml"
    tree = ET.parse(source)
    root = tree.getroot()
    for child in list(root):
        if child.tag in LEFT_OUT:
            root.remove(child)
    balance = root.find("mass_balance")
    if payload > 0:
        # Fuel and load, at the centre of gravity of the empty aircraft, so that the inertia is that of the file.
        empty = balance.find("emptywt")
        mass = ET.SubElement(balance, "pointmass", name="field load")
        ET.SubElement(mass, "weight", unit="LBS").text = str(payload * float(empty.text))
        centre = next(e for e in balance.findall("location") if e.get("name", "CG").upper() == "CG")
        where = ET.SubElement(mass, "location", unit=centre.get("unit", "IN"))
        for axis in "xyz":
            ET.SubElement(where, axis).text = centre.find(axis).text
    for axis in root.find("aerodynamics").findall("axis"):
        if axis.get("name") not in DAMAGE:
            raise ValueError(f"{name}: forces along axis {axis.get('name')} are not understood")
        coefficient, sign, length = DAMAGE[axis.get("name")]
        function = ET.SubElement(axis, "function", name=f"aero/field/d{coefficient}")
        product = ET.SubElement(function, "product")
        factors = ["aero/qbar-psf", "metrics/Sw-sqft", f"field/{coefficient}"]
        for factor in factors + ([length] if length else []):
            ET.SubElement(product, "property").text = factor
        ET.SubElement(product, "value").text = str(sign)
    reactions = ET.Element("external_reactions")
    force = ET.SubElement(reactions, "force", name="thrust", frame="BODY")
    where = ET.SubElement(force, "location", unit="IN")
    direction = ET.SubElement(force, "direction")
    for axis, value in zip("xyz", ("1", "0", "0")):
        ET.SubElement(where, axis).text = "0"
        ET.SubElement(direction, axis).text = value
    root.append(reactions)
    # JSBSim evaluates the axes' functions in their order, and the damage's coefficient before them.
    return tree


def _read_properties(description: pathlib.Path) -> list[str]:
    """Names of properties that the aerodynamics read and do not define."""
    aerodynamics = ET.parse(description).getroot().find("aerodynamics")
    defined = {e.get("name") for e in aerodynamics.iter("function")}
    read = {e.text.strip().lstrip("-") for e in aerodynamics.iter() if e.tag in ("property", "p", "independentVar") and e.text}
    return sorted(read - defined)


class Simulator:
    """An aircraft of JSBSim, to be trimmed and flown. `folder` holds the description that is written for it."""

    def __init__(self, spec, folder: pathlib.Path, step_s: float):
        self.spec, self.step_s, self.folder = spec, step_s, folder
        place = folder / "aircraft" / spec.name
        place.mkdir(parents=True, exist_ok=True)
        _description(spec.name, spec.load).write(place / f"{spec.name}.xml")
        jsbsim.FGJSBBase().debug_lvl = 0
        self.fdm = jsbsim.FGFDMExec(str(folder))
        self.fdm.set_debug_level(0)
        for engine_path in (("set_aircraft_path", "aircraft"), ("set_engine_path", "engine"), ("set_systems_path", "systems")):
            getattr(self.fdm, engine_path[0])(engine_path[1])
        # What a section that is left out would have written (a propeller's slipstream, a buffet) is zero.
        for name in _read_properties(place / f"{spec.name}.xml"):
            if self.fdm.get_property_manager().get_node(name) is None:
                self.fdm[name] = 0.0
        if not self.fdm.load_model(spec.name, True):
            raise RuntimeError(f"{spec.name}: JSBSim does not load its description")
        for name, value in spec.properties.items():
            self.fdm[name] = value
        for coefficient, _, _ in DAMAGE.values():
            self.fdm[f"field/{coefficient}"] = 0.0
        self._prepare()

    def _prepare(self) -> None:
        """What every aircraft begins with."""
        self.fdm.set_dt(self.step_s)
        # Second order for all four integrals: the default of the rotation is the rule of Euler.
        for which in ("rate/rotational", "rate/translational", "position/rotational", "position/translational"):
            self.fdm[f"simulation/integrator/{which}"] = 3 if which != "position/translational" else 4
        self._node = {}
        self._manager = self.fdm.get_property_manager()
        self.changes: dict[str, float] = {}
        # Of the last trim, m/s.
        self.trim_speed = self.spec.speed
        self.surfaces = {"elevator": 0.0, "aileron": 0.0, "rudder": 0.0}

    def node(self, name: str):
        if name not in self._node:
            found = self._manager.get_node(name)
            if found is None:
                raise KeyError(f"{self.spec.name}: JSBSim has no property {name}")
            self._node[name] = found
        return self._node[name]

    def get(self, name: str) -> float:
        return self.node(name).get_double_value()

    def set(self, name: str, value: float) -> None:
        self.node(name).set_double_value(value)

    def set_surfaces(self, elevator: float, aileron: float, rudder: float) -> None:
        """Surfaces (rad) with the signs of Phugoid, straight into the aerodynamics."""
        spec, write = self.spec, self.set
        self.surfaces = {"elevator": elevator, "aileron": aileron, "rudder": rudder}
        signs = spec.signs
        elevator, aileron, rudder = elevator * signs[0], aileron * signs[1], rudder * signs[2]
        write("fcs/elevator-pos-rad", elevator)
        write("fcs/mag-elevator-pos-rad", abs(elevator))
        write("fcs/left-aileron-pos-rad", aileron)
        write("fcs/right-aileron-pos-rad", -aileron)
        write("fcs/rudder-pos-rad", rudder)
        if spec.full_deflections:
            full = spec.full_deflections
            write("fcs/elevator-pos-norm", elevator / full[0])
            write("fcs/left-aileron-pos-norm", aileron / full[1])
            write("fcs/right-aileron-pos-norm", -aileron / full[1])
            write("fcs/rudder-pos-norm", rudder / full[2])

    def begin(self, trim: dict[str, float], below: float = 0.0) -> None:
        """To the state of this trim, without damage. `below`: see `trim`."""
        self.changes = {}
        for coefficient, _, _ in DAMAGE.values():
            self.set(f"field/{coefficient}", 0.0)
        self.set_surfaces(trim["elevator"], trim["aileron"], trim["rudder"])
        self.set_thrust(trim["thrust"])
        self.start(trim["speed"], trim["altitude"], trim["alpha"], 0.0, trim["phi"], climb=trim["climb"])
        self.place_thrust(below)

    def follow(self, asked: tuple[float, float, float]) -> None:
        """One step of the actuators towards these angles (rad)."""
        lag = 1 - math.exp(-ACTUATOR * self.step_s)
        self.set_surfaces(*(x + lag * (min(max(a, -LIMIT), LIMIT) - x) for x, a in zip(self.surfaces.values(), asked)))

    def set_thrust(self, newton: float) -> None:
        self.set("external_reactions/thrust/magnitude", newton / LBF)

    @property
    def thrust(self) -> float:
        """Along body x, N."""
        return self.get("external_reactions/thrust/magnitude") * LBF

    def set_wind(self, north: float, east: float, down: float) -> None:
        """Velocity of the air over the ground, m/s."""
        self.set("atmosphere/gust-north-fps", north / FT)
        self.set("atmosphere/gust-east-fps", east / FT)
        self.set("atmosphere/gust-down-fps", down / FT)

    def begin_turbulence(self, wind: float, severity: int, seed: int) -> None:
        """From now on JSBSim's own turbulence: gusts along three axes and the turning of the air about them, with the spectra of
        MIL-F-8785C. `wind` at 20 feet, ft/s; `severity` from 1 to 7."""
        self.set("simulation/randomseed", seed % 2**31)
        self.set("atmosphere/turbulence/milspec/windspeed_at_20ft_AGL-fps", wind)
        self.set("atmosphere/turbulence/milspec/severity", severity)
        # By the bilinear transformation.
        self.set("atmosphere/turb-type", 4)

    def start(self, speed: float, altitude: float, alpha: float, beta: float = 0.0, phi: float = 0.0, rates=(0, 0, 0), climb: float = 0.0):
        """Initial condition: m/s, m, rad, rad/s; heading north. `climb` is the angle of the flight path, rad, in flight without bank."""
        fdm = self.fdm
        fdm["ic/lat-geod-deg"] = 47.0
        fdm["ic/long-gc-deg"] = 8.0
        fdm["ic/h-sl-ft"] = altitude / FT
        fdm["ic/psi-true-deg"] = 0.0
        fdm["ic/theta-rad"] = alpha + climb
        fdm["ic/phi-rad"] = phi
        fdm["ic/u-fps"] = speed * math.cos(alpha) * math.cos(beta) / FT
        fdm["ic/v-fps"] = speed * math.sin(beta) / FT
        fdm["ic/w-fps"] = speed * math.sin(alpha) * math.cos(beta) / FT
        for axis, rate in zip("pqr", rates):
            fdm[f"ic/{axis}-rad_sec"] = rate
        if not fdm.run_ic():
            raise RuntimeError(f"{self.spec.name}: JSBSim cannot start")

    def step(self) -> None:
        """One step with the damage of now. The change is computed before the step, from the state at its beginning."""
        if self.changes:
            self._apply_changes()
        if not self.fdm.run():
            raise RuntimeError(f"{self.spec.name}: JSBSim stopped")

    def _apply_changes(self) -> None:
        values = self.variables()
        sums: dict[str, float] = {}
        for name, change in self.changes.items():
            coefficient, variable = name.split("_", 1)
            sums[coefficient] = sums.get(coefficient, 0.0) + change * values[variable]
        for coefficient, value in sums.items():
            self.set(f"field/{coefficient}", value)

    def variables(self) -> dict[str, float]:
        """Variables of the terms of a model file, with its normalisation."""
        speed = self.get("velocities/vt-fps")
        half_chord, half_span = self.chord / FT / (2 * speed), self.span / FT / (2 * speed)
        return {
            "0": 1.0,
            "alpha": self.get("aero/alpha-rad"),
            "beta": self.get("aero/beta-rad"),
            "p": self.get("velocities/p-aero-rad_sec") * half_span,
            "q": self.get("velocities/q-aero-rad_sec") * half_chord,
            "r": self.get("velocities/r-aero-rad_sec") * half_span,
            "V": speed * FT / self.trim_speed,
            "alpha2": self.get("aero/alpha-rad") ** 2,
            "beta2": self.get("aero/beta-rad") ** 2,
            "abs_elevator": abs(self.surfaces["elevator"]),
            **self.surfaces,
        }

    # What a model file says of the aircraft.

    @property
    def wing_area(self) -> float:
        return self.get("metrics/Sw-sqft") * FT * FT

    @property
    def chord(self) -> float:
        return self.get("metrics/cbarw-ft") * FT

    @property
    def span(self) -> float:
        return self.get("metrics/bw-ft") * FT

    @property
    def mass(self) -> float:
        return self.get("inertia/mass-slugs") * SLUG

    def inertia(self) -> dict[str, float]:
        # JSBSim shows the element of its inertia matrix, which is minus the product of inertia.
        sign = {"ixz": -1}
        return {k: sign.get(k, 1) * self.get(f"inertia/{k}-slugs_ft2") * SLUG_FT2 for k in ("ixx", "iyy", "izz", "ixz")}

    def place_thrust(self, below: float = 0.0) -> None:
        """Puts the thrust line through the centre of gravity, or this part of the chord below it."""
        for axis in "xyz":
            self.set(f"external_reactions/thrust/location-{axis}-in", self.get(f"inertia/cg-{axis}-in"))
        # JSBSim's structural frame: z up, inches.
        lower = below * self.get("metrics/cbarw-ft") * 12
        self.set("external_reactions/thrust/location-z-in", self.get("inertia/cg-z-in") - lower)

    def coefficients(self) -> dict[str, float]:
        """The aerodynamic coefficients of now, exactly as JSBSim has them, about the centre of gravity."""
        force = self.get("aero/qbar-psf") * self.get("metrics/Sw-sqft")
        cx, cy, cz = (self.get(f"forces/fb{a}-aero-lbs") / force for a in "xyz")
        alpha = self.get("aero/alpha-rad")
        s, c = math.sin(alpha), math.cos(alpha)
        chord, span = self.get("metrics/cbarw-ft"), self.get("metrics/bw-ft")
        return {
            "CL": cx * s - cz * c,
            "CD": -cx * c - cz * s,
            "CY": cy,
            "Cl": self.get("moments/l-aero-lbsft") / force / span,
            "Cm": self.get("moments/m-aero-lbsft") / force / chord,
            "Cn": self.get("moments/n-aero-lbsft") / force / span,
        }

    def specific_force(self) -> tuple[float, float, float]:
        """What ideal accelerometers at the centre of gravity show, m/s2."""
        mass = self.get("inertia/mass-slugs")
        x = self.get("forces/fbx-aero-lbs") + self.get("external_reactions/thrust/magnitude")
        y, z = self.get("forces/fby-aero-lbs"), self.get("forces/fbz-aero-lbs")
        return x / mass * FT, y / mass * FT, z / mass * FT

    def trim(self, speed: float, altitude: float, gliding: bool = False, below: float = 0.0) -> dict[str, float]:
        """Straight flight, by Newton's method on six accelerations: alpha, thrust, elevator, phi, aileron, rudder. It is level,
        or without thrust (`gliding`): then the angle of the flight path, `climb` (rad), is found in the place of the thrust.
        `below`: how far the thrust line lies below the centre of gravity, as a part of the chord."""

        def residual(x):
            thrust, climb = (0.0, x[1]) if gliding else (x[1], 0.0)
            self.set_surfaces(x[2], x[4], x[5])
            self.set_thrust(thrust * self.mass * 9.8)
            self.start(speed, altitude, x[0], 0.0, x[3], climb=climb)
            self.place_thrust(below)
            self.start(speed, altitude, x[0], 0.0, x[3], climb=climb)
            return np.array([
                self.get(f"accelerations/{a}dot-ft_sec2") * FT / 9.8 for a in "uvw"
            ] + [self.get(f"accelerations/{a}dot-rad_sec2") for a in "pqr"])

        x = np.array([0.05, 0.1, -0.02, 0.0, 0.0, 0.0])
        for _ in range(25):
            r = residual(x)
            if np.abs(r).max() < 1e-9:
                break
            jacobian = np.empty((6, 6))
            for k in range(6):
                h = 1e-5
                up = x.copy()
                up[k] += h
                down = x.copy()
                down[k] -= h
                jacobian[:, k] = (residual(up) - residual(down)) / (2 * h)
            change = np.linalg.solve(jacobian, -r)
            x = x + change * min(1.0, 0.2 / max(np.abs(change).max(), 1e-12))
        r = residual(x)
        names = ("alpha", "thrust", "elevator", "phi", "aileron", "rudder")
        trim = dict(zip(names, map(float, x)))
        trim["climb"] = trim["thrust"] if gliding else 0.0
        trim["theta"] = trim["alpha"] + trim["climb"]
        trim["thrust"] *= 0.0 if gliding else self.mass * 9.8
        trim |= {"speed": speed, "altitude": altitude, "residual": float(np.abs(r).max())}
        self.trim_speed = speed
        return trim

    def response(self, trim: dict[str, float]) -> dict[str, float]:
        """Angular accelerations per radian and per rad/s about the trim, from which inputs and gains are chosen: `M_alpha`,
        `M_q`, `M_elevator`, `L_p`, `L_aileron`, `N_beta`, `N_rudder` (1/s2, 1/s)."""

        def accelerations(alpha=0.0, beta=0.0, rates=(0, 0, 0), elevator=0.0, aileron=0.0, rudder=0.0):
            self.set_surfaces(trim["elevator"] + elevator, trim["aileron"] + aileron, trim["rudder"] + rudder)
            self.start(trim["speed"], trim["altitude"], trim["alpha"] + alpha, beta, trim["phi"], rates, trim["climb"])
            return {a: self.get(f"accelerations/{a}dot-rad_sec2") for a in "pqr"}

        def slope(axis, h=0.01, **one):
            up = accelerations(**{k: tuple(h * x for x in v) if isinstance(v, tuple) else h * v for k, v in one.items()})
            down = accelerations(**{k: tuple(-h * x for x in v) if isinstance(v, tuple) else -h * v for k, v in one.items()})
            return (up[axis] - down[axis]) / (2 * h)

        return {
            "M_alpha": slope("q", alpha=1.0),
            "M_q": slope("q", rates=(0.0, 1.0, 0.0)),
            "M_elevator": slope("q", elevator=1.0),
            "L_p": slope("p", rates=(1.0, 0.0, 0.0)),
            "L_aileron": slope("p", aileron=1.0),
            "N_beta": slope("r", beta=1.0),
            "N_rudder": slope("r", rudder=1.0),
        }

    def derivative(self, trim: dict[str, float], coefficient: str, variable: str) -> float:
        """A derivative about the trim, by central differences over one degree (or 0.002 of a normalised rate)."""
        h = {"p": 0.02, "q": 0.002, "r": 0.02}.get(variable, 0.0175)
        values = []
        for sign in (1, -1):
            move = {v: 0.0 for v in VARIABLES} | {variable: sign * h}
            half_chord, half_span = self.chord / (2 * trim["speed"]), self.span / (2 * trim["speed"])
            rates = (move["p"] / half_span, move["q"] / half_chord, move["r"] / half_span)
            self.set_surfaces(*(trim[s] + move[s] for s in ("elevator", "aileron", "rudder")))
            self.start(trim["speed"], trim["altitude"], trim["alpha"] + move["alpha"], move["beta"], trim["phi"], rates, trim["climb"])
            values.append(self.coefficients()[coefficient])
        return (values[0] - values[1]) / (2 * h)
