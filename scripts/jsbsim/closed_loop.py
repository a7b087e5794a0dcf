#!/usr/bin/env python3
"""Lets JSBSim fly aircraft with their flight control as scenarios fly them, and compares: rates, attitude, angle of attack and
surfaces.

    scripts/jsbsim/closed_loop.py [--write] [AIRCRAFT ...]

Needs the package jsbsim (scripts/python-tools.sh) and target/release/phugoid. The scenarios are in
crates/phugoid-aircraft/tests/integration/jsbsim/closed_loop; with --write the flights of JSBSim go there too, twice a second, for
the tests.

In JSBSim the engines are taken out of a copy of the aircraft, and a constant force along body x acts in the centre of gravity, as
in the scenarios. The earth does not rotate, and is so large that it is flat, with the gravity of the scenarios. Where the flight
begins is what phugoid trims. Before it begins, JSBSim is put there again before each step, so that the channels come to rest.
Which position of the stick stands for an angle is found there by trying: the one with which the surface rests at that angle.
"""

import argparse
import json
import math
import os
import re
import shutil
import subprocess
import tempfile
import tomllib

FOOT = 0.3048
POUND_FORCE = 4.4482216152605
GRAVITY = 9.80665
EARTH = 6356766.0
FLAT_FT = 1e9
STEP = 0.0005
REST_S = 0.5
EVERY = 0.5
HERE = os.path.dirname(os.path.abspath(__file__))
FLIGHTS = os.path.join(HERE, "../../crates/phugoid-aircraft/tests/integration/jsbsim/closed_loop")
PHUGOID = os.path.join(HERE, "../../target/release/phugoid")
SURFACES = ["elevator", "aileron", "rudder"]
POSITIONS = ["fcs/elevator-pos-rad", "fcs/left-aileron-pos-rad", "fcs/rudder-pos-rad"]
STICKS = [f"fcs/{surface}-cmd-norm" for surface in SURFACES]
SIGNS = [1.0, -1.0, 1.0]
COLUMNS = ["p", "q", "r", "phi", "theta", "alpha", *SURFACES]
# What parts that are taken out would make.
MADE_ELSEWHERE = {
    "fokker100": [f"propulsion/engine[{k}]/reverser-angle-rad" for k in (0, 1)],
    "c310": [f"fcs/{lever}-cmd-norm[{k}]" for lever in ("throttle", "mixture") for k in (0, 1)],
}


def ours(folder, name):
    """Flies the scenario with phugoid: its trim, and its true flight by column."""
    import jsbsim

    with open(os.path.join(FLIGHTS, f"{name}.toml")) as file:
        text = file.read().replace("PACKAGE", os.path.dirname(jsbsim.__file__))
    place = os.path.join(folder, f"{name}.toml")
    with open(place, "w") as file:
        file.write(text)
    out = os.path.join(folder, name)
    done = subprocess.run([PHUGOID, "simulate", place, "--out", out, "--json"], check=True, capture_output=True, text=True)
    with open(os.path.join(out, "truth.csv")) as file:
        lines = [line for line in file.read().splitlines() if not line.startswith("#")]
    names = [re.sub(r"_(rad_s|rad|m_s|m|N|s)$", "", column) for column in lines[0].split(",")]
    rows = [[float(value) for value in line.split(",")] for line in lines[1:]]
    return tomllib.loads(text), json.loads(done.stdout)["trim"], {column: [row[k] for row in rows] for k, column in enumerate(names)}


class Jsbsim:
    """An aircraft in JSBSim in the trim of a scenario."""

    def __init__(self, folder, name, trim):
        import jsbsim

        package = os.path.dirname(jsbsim.__file__)
        self.root, self.name, self.trim = os.path.join(folder, f"{name}.jsbsim"), name, trim
        os.makedirs(os.path.join(self.root, "aircraft"))
        for part in ("engine", "systems"):
            os.symlink(os.path.join(package, part), os.path.join(self.root, part))
        shutil.copytree(os.path.join(package, "aircraft", name), os.path.join(self.root, "aircraft", name))
        self.file = os.path.join(self.root, "aircraft", name, f"{name}.xml")
        with open(self.file, encoding="latin-1") as file:
            text = file.read()
        text = re.sub(r'<system file="pushback"(/>|.*?</system>)', "", text, flags=re.S)
        text = re.sub(r"<external_reactions.*?</external_reactions>", "", text, flags=re.S)
        # Tanks stay, for the mass.
        engines = re.compile(r"<engine\b.*?</engine>", re.S)
        self.text = re.sub(r"<propulsion.*?</propulsion>", lambda found: engines.sub("", found.group(0)), text, flags=re.S)
        # Ours counts geopotential altitudes.
        self.height_ft = EARTH * trim["altitude_m"] / (EARTH - trim["altitude_m"]) / FOOT
        attraction = GRAVITY / FOOT * (FLAT_FT + self.height_ft) ** 2
        with open(os.path.join(self.root, "planet.xml"), "w") as file:
            file.write(
                f'<planet name="flat"><semimajor_axis unit="FT">{FLAT_FT}</semimajor_axis>'
                f'<semiminor_axis unit="FT">{FLAT_FT}</semiminor_axis><rotation_rate unit="RAD/SEC">0</rotation_rate>'
                f'<GM unit="FT3/SEC2">{attraction}</GM><J2>0</J2></planet>'
            )
        self.load([0.0, 0.0, 0.0])
        self.load([self.flight[f"inertia/cg-{axis}-in"] for axis in "xyz"])
        self.sticks = [0.0, 0.0, 0.0]
        self.flight["external_reactions/thrust/magnitude"] = trim["thrust_n"] / POUND_FORCE
        # The gear goes up meanwhile.
        self.rest(10.0)

    def load(self, centre):
        import jsbsim

        x, y, z = centre
        force = (
            f'<external_reactions><force name="thrust" frame="BODY"><location unit="IN"><x>{x}</x><y>{y}</y><z>{z}</z></location>'
            "<direction><x>1</x><y>0</y><z>0</z></direction></force></external_reactions>"
        )
        end = self.text.rindex("</fdm_config>")
        with open(self.file, "w", encoding="latin-1") as file:
            file.write(self.text[:end] + force + self.text[end:])
        jsbsim.FGJSBBase().debug_lvl = 0
        self.flight = jsbsim.FGFDMExec(self.root)
        self.flight.set_debug_level(0)
        # Components keep the step that there is when they are loaded.
        self.flight.set_dt(STEP)
        for made in MADE_ELSEWHERE.get(self.name, []):
            self.flight.set_property_value(made, 0.0)
        self.flight.load_planet(os.path.join(self.root, "planet.xml"), False)
        if not self.flight.load_model(self.name):
            raise SystemExit(f"JSBSim does not load {self.name}")
        self.flight.disable_output()
        self.begin()

    def begin(self):
        """Puts the aircraft into the trim; the channels keep what they remember."""
        at = {
            "h-sl-ft": self.height_ft,
            "vt-fps": self.trim["speed_m_s"] / FOOT,
            "beta-rad": self.trim["beta_rad"],
            "alpha-rad": self.trim["alpha_rad"],
            "phi-rad": self.trim["phi_rad"],
            "theta-rad": self.trim["theta_rad"],
            "psi-true-rad": 0.0,
            "p-rad_sec": 0.0,
            "q-rad_sec": 0.0,
            "r-rad_sec": 0.0,
        }
        for name, value in at.items():
            self.flight[f"ic/{name}"] = value
        self.flight["gear/gear-cmd-norm"] = 0.0
        self.flight.run_ic()

    def move(self):
        for stick, value in zip(STICKS, getattr(self, "sticks", [0.0] * 3)):
            self.flight[stick] = value

    def rest(self, seconds):
        """Lets the channels run in the trim; gives the surfaces."""
        for _ in range(round(seconds / STEP)):
            self.begin()
            self.move()
            self.flight.run()
        return self.surfaces()

    def surfaces(self):
        return [sign * self.flight[position] for sign, position in zip(SIGNS, POSITIONS)]

    def stick_for(self, surface, angle):
        """The position of the stick with which a surface rests at an angle, the others where they are."""
        before = self.sticks[surface]
        off = []
        at = [before, before + 0.05]
        for tried in at:
            self.sticks[surface] = tried
            off.append(self.rest(REST_S)[surface] - angle)
        for _ in range(20):
            if abs(off[-1]) < 1e-9 or off[-1] == off[-2]:
                break
            at.append(at[-1] - off[-1] * (at[-1] - at[-2]) / (off[-1] - off[-2]))
            self.sticks[surface] = at[-1]
            off.append(self.rest(REST_S)[surface] - angle)
        self.sticks[surface] = before
        return at[-1]


def manoeuvres(scenario):
    """Start, width, surface and amplitude (rad) of the doublets."""
    number = lambda text: float(text.split()[0])
    return [
        (number(one["start"]), number(one["width"]), SURFACES.index(one["surface"]), math.radians(number(one["amplitude"])))
        for one in scenario.get("manoeuvre", [])
    ]


def theirs(folder, name, scenario, trim):
    """The flight of JSBSim, by column, at the samples of the scenario."""
    aircraft = Jsbsim(folder, name, trim)
    flight = aircraft.flight
    angles = [trim[f"{surface}_rad"] for surface in SURFACES]
    for surface, angle in enumerate(angles):
        aircraft.sticks[surface] = aircraft.stick_for(surface, angle)
    moves = manoeuvres(scenario)
    asked = {(move[2], move[3] * side) for move in moves for side in (1.0, -1.0)}
    positions = {(surface, angle): aircraft.stick_for(surface, angles[surface] + angle) for surface, angle in asked}
    still = aircraft.rest(1.0)
    print(f"{name}: off the angles of trim by {max(abs(a - b) for a, b in zip(still, angles)):.1e} rad")
    aircraft.begin()
    for key, value in scenario["aircraft"].get("properties", {}).items():
        # A height, which ours counts in geopotential feet.
        flight[key] = value + (aircraft.height_ft - trim["altitude_m"] / FOOT) * ("altitude_setpoint" in key)
    rate = float(scenario["sample_rate"].split()[0])
    steps, count = round(1.0 / rate / STEP), round(float(scenario["duration"].split()[0]) * rate) + 1
    columns = {column: [] for column in COLUMNS}
    hold = list(aircraft.sticks)
    for k in range(count * steps):
        time = k * STEP + 1e-9
        aircraft.sticks = list(hold)
        for start, width, surface, amplitude in moves:
            if start <= time < start + 2.0 * width:
                aircraft.sticks[surface] = positions[surface, amplitude if time < start + width else -amplitude]
        aircraft.move()
        if k % steps == 0:
            for column in "pqr":
                columns[column].append(flight[f"velocities/{column}-rad_sec"])
            for column in ("phi", "theta"):
                columns[column].append(flight[f"attitude/{column}-rad"])
            columns["alpha"].append(flight["aero/alpha-rad"])
        flight.run()
        if k % steps == 0:
            # The surfaces are those with the commands of this instant.
            for column, angle in zip(SURFACES, aircraft.surfaces()):
                columns[column].append(angle)
    return rate, columns


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--write", action="store_true")
    parser.add_argument("aircraft", nargs="*")
    arguments = parser.parse_args()
    names = arguments.aircraft or sorted(file[:-5] for file in os.listdir(FLIGHTS) if file.endswith(".toml"))
    for name in names:
        with tempfile.TemporaryDirectory() as folder:
            scenario, trim, flown = ours(folder, name)
            rate, columns = theirs(folder, name, scenario, trim)
        for column in COLUMNS:
            most = max(abs(a - b) for a, b in zip(flown[column], columns[column]))
            whole = max(columns[column]) - min(columns[column])
            print(f"  {column:9} differs by {most:.1e} at most, and goes over {whole:.1e}")
        if arguments.write:
            every = round(EVERY * rate)
            with open(os.path.join(FLIGHTS, f"{name}.csv"), "w") as out:
                out.write("t," + ",".join(COLUMNS) + "\n")
                # Between the instants at which commands change, where a surface jumps.
                for k in range(every // 2, len(columns["p"]), every):
                    out.write(f"{k / rate:g}," + ",".join(f"{columns[column][k]:.6e}" for column in COLUMNS) + "\n")


if __name__ == "__main__":
    main()
