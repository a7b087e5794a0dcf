"""The exported model in JSBSim: forces and moments of a tiny aircraft with our <aerodynamics> section against the equations of the
model file, evaluated here independently in SI. And the parameters for Gazebo: well-formed, with the names of the plugin's source."""

import math
import os
import pathlib
import subprocess
import tempfile
import xml.etree.ElementTree as ElementTree

import jsbsim

EXPORT = pathlib.Path(os.environ["PHUGOID_EXAMPLES"]) / "export_model"
FOOT, POUND = 0.3048, 4.4482216152605  # m; N per pound of force, both exact
# Of the largest force or moment: both sides compute in doubles, in different order and units; 4e-16 was measured.
TOLERANCE = 1e-12

HEAD = """name = "tiny aircraft"
axes = ["longitudinal", "lateral"]
{rates}
[aircraft]
mass = 100.0
ixx = 20.0
iyy = 30.0
izz = 45.0
ixz = 1.0
wing_area = 2.5
wing_span = 5.0
mean_chord = 0.52
thrust = 0.0
air_density = 1.2
reference_speed = 40.0
gravity = 9.80665
[reference]
alpha = 0.03
elevator = -0.02
"""
TERMS = {
    "CL": {"1": 0.31, "alpha": 5.1, "q_hat": 6.2, "elevator": 0.41, "alpha^2": -2.7},
    "CD": {"1": 0.031, "alpha": 0.23, "alpha^2": 1.9, "v_hat": 0.004},
    "Cm": {"1": 0.02, "alpha": -0.93, "q_hat": -14.5, "elevator": -1.32, "alpha*elevator": 0.35},
    "CY": {"beta": -0.61, "p_hat": 0.04, "r_hat": 0.33, "rudder": 0.17},
    "Cl": {"beta": -0.07, "p_hat": -0.48, "r_hat": 0.11, "aileron": -0.21, "rudder": 0.01},
    "Cn": {"1": 0.001, "beta": 0.09, "p_hat": -0.05, "r_hat": -0.13, "aileron": 0.02, "rudder": -0.08},
}
AIRCRAFT = """<?xml version="1.0"?>
<fdm_config name="tiny" version="2.0">
<fileheader/>
<metrics>
  <wingarea unit="FT2">{area}</wingarea><wingspan unit="FT">{span}</wingspan><chord unit="FT">{chord}</chord>
  <location name="AERORP" unit="IN"><x>0</x><y>0</y><z>0</z></location>
  <location name="EYEPOINT" unit="IN"><x>0</x><y>0</y><z>0</z></location>
  <location name="VRP" unit="IN"><x>0</x><y>0</y><z>0</z></location>
</metrics>
<mass_balance>
  <ixx unit="SLUG*FT2">20</ixx><iyy unit="SLUG*FT2">30</iyy><izz unit="SLUG*FT2">45</izz>
  <emptywt unit="LBS">220</emptywt>
  <location name="CG" unit="IN"><x>0</x><y>0</y><z>0</z></location>
</mass_balance>
<ground_reactions/>
<propulsion/>
<flight_control name="none"/>
{aerodynamics}
</fdm_config>
"""


def parameter(coefficient, term):
    short = {"1": "0", "v_hat": "V", "alpha^2": "alpha2", "alpha*elevator": "alpha_elevator"}
    return f"{coefficient}_{short.get(term, term.removesuffix('_hat'))}"


def model(rates, build_up=TERMS):
    text = HEAD.format(rates=rates) + "[coefficients]\n"
    for coefficient, terms in build_up.items():
        text += f"{coefficient} = [{', '.join(chr(34) + t + chr(34) for t in terms)}]\n"
    text += "[parameters]\n"
    for coefficient, terms in build_up.items():
        for term, value in terms.items():
            text += f"{parameter(coefficient, term)} = {{ start = {value}, prior_std = 1.0 }}\n"
    return text


def export(folder, text, form):
    file = folder / "model.toml"
    file.write_text(text)
    run = subprocess.run([EXPORT, file, form], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return run.stdout


def expected(fdm, reference_rates):
    """Forces along body x, y, z (N) and moments (N m) by the model file's equations."""
    get = fdm.get_property_value
    speed, density = get("velocities/vt-fps") * FOOT, get("atmosphere/rho-slugs_ft3") * POUND / FOOT**4
    alpha, beta = get("aero/alpha-rad"), get("aero/beta-rad")
    p, q, r = (get(f"velocities/{axis}-aero-rad_sec") for axis in "pqr")
    area, span, chord = 2.5, 5.0, 0.52
    by = 2 * (40.0 if reference_rates else speed)
    variables = {
        "alpha": alpha - 0.03,
        "beta": beta,
        "p_hat": p * span / by,
        "q_hat": q * chord / by,
        "r_hat": r * span / by,
        "v_hat": speed / 40.0,
        "elevator": get("fcs/elevator-pos-rad") + 0.02,
        "aileron": get("fcs/right-aileron-pos-rad"),
        "rudder": get("fcs/rudder-pos-rad"),
    }

    def value(term):
        if term == "1":
            return 1.0
        if term == "alpha^2":
            return variables["alpha"] ** 2
        return math.prod(variables[name] for name in term.split("*"))

    c = {name: sum(v * value(term) for term, v in terms.items()) for name, terms in TERMS.items()}
    force = 0.5 * density * speed**2 * area
    sin, cos = math.sin(alpha), math.cos(alpha)
    return [
        force * (c["CL"] * sin - c["CD"] * cos),
        force * c["CY"],
        -force * (c["CL"] * cos + c["CD"] * sin),
        force * span * c["Cl"],
        force * chord * c["Cm"],
        force * span * c["Cn"],
    ]


def found(fdm):
    get = fdm.get_property_value
    forces = [get(f"forces/fb{axis}-aero-lbs") * POUND for axis in "xyz"]
    return forces + [get(f"moments/{axis}-aero-lbsft") * POUND * FOOT for axis in ("l", "m", "n")]


def check_jsbsim(folder, rates):
    section = export(folder, model(rates), "jsbsim")
    (folder / "aircraft" / "tiny").mkdir(parents=True, exist_ok=True)
    aircraft = AIRCRAFT.format(area=2.5 / FOOT**2, span=5.0 / FOOT, chord=0.52 / FOOT, aerodynamics=section)
    (folder / "aircraft" / "tiny" / "tiny.xml").write_text(aircraft)
    worst = 0.0
    for alpha, beta, p, q, r, elevator, aileron, rudder, speed in [
        (2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 150.0),
        (5.0, 4.0, 0.3, -0.2, 0.1, -0.1, 0.05, 0.08, 131.0),
        (-3.0, -7.0, -0.6, 0.4, -0.3, 0.12, -0.1, -0.05, 220.0),
        (11.0, 2.0, 0.1, 0.7, 0.2, -0.2, 0.15, 0.2, 95.0),
    ]:
        fdm = jsbsim.FGFDMExec(str(folder))
        fdm.set_debug_level(0)
        assert fdm.load_model("tiny"), "JSBSim does not load the section"
        for name, value in {
            "ic/h-sl-ft": 3000.0, "ic/vt-fps": speed, "ic/alpha-deg": alpha, "ic/beta-deg": beta,
            "ic/p-rad_sec": p, "ic/q-rad_sec": q, "ic/r-rad_sec": r,
        }.items():
            fdm.set_property_value(name, value)
        surfaces = {"elevator": elevator, "right-aileron": aileron, "rudder": rudder}
        for name, value in surfaces.items():
            fdm.set_property_value(f"fcs/{name}-pos-rad", value)
        assert fdm.run_ic()
        for name, value in surfaces.items():
            assert fdm.get_property_value(f"fcs/{name}-pos-rad") == value
        ours, theirs = expected(fdm, "reference" in rates), found(fdm)
        scales = [max(abs(v) for v in ours[:3])] * 3 + [max(abs(v) for v in ours[3:])] * 3
        for name, a, b, scale in zip("XYZLMN", ours, theirs, scales):
            worst = max(worst, abs(a - b) / scale)
            assert abs(a - b) <= TOLERANCE * scale, f"{name} at {alpha} deg: {a} here, {b} in JSBSim"
    print(f"  JSBSim: largest difference {worst:.1e} of the largest force or moment")


# The elements that gz-sim's AdvancedLiftDrag.cc reads.
GAZEBO = set("CL0 CD0 Cem0 AR mac eff area air_density forward upward link_name cp alpha_stall Cema_stall".split())
GAZEBO |= {c + v for c in ("CL", "CY", "Cell", "Cem", "Cen") for v in "ab"}
GAZEBO |= {c + v for c in ("CL", "CD", "CY", "Cell", "Cem", "Cen") for v in "pqr"} | {"num_ctrl_surfaces", "control_surface"}


def check_gazebo(folder):
    root = ElementTree.fromstring("<model>" + export(folder, model(""), "gazebo") + "</model>")
    plugin = root.find("plugin")
    assert plugin.get("name") == "gz::sim::systems::AdvancedLiftDrag"
    assert {element.tag for element in plugin} == GAZEBO, {e.tag for e in plugin} ^ GAZEBO
    value = lambda name: float(plugin.find(name).text)
    assert value("Cemq") == -14.5 and value("Cellb") == -0.07 and value("CYb") == -0.61 and value("Cenr") == -0.13
    surfaces = plugin.findall("control_surface")
    assert [s.find("name").text for s in surfaces] == ["elevator_joint", "aileron_joint", "rudder_joint"]
    assert len(surfaces) == value("num_ctrl_surfaces")
    # The plugin multiplies by degrees.
    assert math.isclose(float(surfaces[0].find("Cem_ctrl").text), -1.32 * math.pi / 180, rel_tol=1e-15)
    # The constant term counts from zero angle of attack and zero deflection; the tangent of alpha^2 at its reference is zero.
    assert math.isclose(value("CL0"), 0.31 - 5.1 * 0.03 + 0.41 * 0.02, rel_tol=1e-12)
    print("  Gazebo: every element is one that the plugin reads")
    check_plugin_equations(folder)


# What the plugin has a place for: terms of first order.
LINEAR = {
    "CL": {"1": 0.31, "alpha": 5.1, "q_hat": 6.2, "elevator": 0.41},
    "CD": {"1": 0.031, "alpha": 0.23, "elevator": 0.02},
    "Cm": {"1": 0.02, "alpha": -0.93, "q_hat": -14.5, "elevator": -1.32},
    "CY": {"beta": -0.61, "p_hat": 0.04, "r_hat": 0.33, "rudder": 0.17},
    "Cl": {"beta": -0.07, "p_hat": -0.48, "r_hat": 0.11, "aileron": -0.21, "rudder": 0.01},
    "Cn": {"beta": 0.09, "p_hat": -0.05, "r_hat": -0.13, "aileron": 0.02, "rudder": -0.08},
}


def plugin(element, state):
    """Coefficients by the equations of AdvancedLiftDrag.cc far below the stall, where `Cem` is added to and not assigned: the rates enter as
    forces, half the density times the speed times a rate times half a length; joint angles count in degrees."""
    def number(name):
        found = element.find(name)
        return 0.0 if found is None else float(found.text)

    speed, span, density = state["speed"], math.sqrt(number("area") * number("AR")), number("air_density")
    pressure = 0.5 * density * speed**2
    coefficients = {}
    for name in ("CL", "CD", "CY", "Cell", "Cem", "Cen"):
        if name == "CD":
            value = number("CD0") + coefficients["CL"] ** 2 / (math.pi * number("AR") * number("eff"))
        else:
            value = number(name + "0") + number(name + "a") * state["alpha"] + number(name + "b") * state["beta"]
        for surface in element.findall("control_surface"):
            joint = state[surface.find("name").text.removesuffix("_joint")] * 180 / math.pi
            value += joint * float(surface.find(name + "_ctrl").text) * float(surface.find("direction").text)
        coefficients[name] = value
    forces = {name: value * pressure for name, value in coefficients.items()}
    for name in forces:
        for rate, length in (("p", span), ("q", number("mac")), ("r", span)):
            forces[name] += number(name + rate) * (state[rate] * length / 2) * 0.5 * density * speed
    return {name: force / pressure for name, force in forces.items()}


def check_plugin_equations(folder):
    root = ElementTree.fromstring("<model>" + export(folder, model("", LINEAR), "gazebo") + "</model>")
    worst = 0.0
    for alpha, beta, p, q, r, elevator, aileron, rudder, speed in [
        # The reference of the model file, where the flight is taken to be: the drag too has to be the same there.
        (0.03, 0.0, 0.0, 0.0, 0.0, -0.02, 0.0, 0.0, 40.0),
        (0.09, 0.05, 0.3, -0.2, 0.1, -0.1, 0.05, 0.08, 31.0),
        (-0.05, -0.1, -0.6, 0.4, -0.3, 0.12, -0.1, -0.05, 55.0),
    ]:
        state = dict(alpha=alpha, beta=beta, p=p, q=q, r=r, elevator=elevator, aileron=aileron, rudder=rudder, speed=speed)
        values = {"1": 1.0, "alpha": alpha - 0.03, "beta": beta, "elevator": elevator + 0.02, "aileron": aileron, "rudder": rudder}
        values |= {f"{rate}_hat": state[rate] * length / (2 * speed) for rate, length in (("p", 5.0), ("q", 0.52), ("r", 5.0))}
        theirs = plugin(root.find("plugin"), state)
        for ours, name in (("CL", "CL"), ("CD", "CD"), ("CY", "CY"), ("Cl", "Cell"), ("Cm", "Cem"), ("Cn", "Cen")):
            if ours == "CD" and alpha != 0.03:
                continue
            wanted = sum(value * values[term] for term, value in LINEAR[ours].items())
            worst = max(worst, abs(theirs[name] - wanted))
            assert abs(theirs[name] - wanted) <= TOLERANCE, f"{name}: {wanted} here, {theirs[name]} in the plugin, at {state}"
    print(f"  Gazebo: by the plugin's equations, coefficients within {worst:.1e}")



with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    check_jsbsim(folder, "")
    check_jsbsim(folder, 'rate_speed = "reference"')
    check_gazebo(folder)
