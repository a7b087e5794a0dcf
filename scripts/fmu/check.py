"""Exports aircraft as FMUs, and fails where FMPy finds them wrong or where they move otherwise than `phugoid simulate` says.

Usage: check.py FOLDER-OF-THE-PROGRAM FOLDER-FOR-FILES
"""

import csv
import ctypes
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading
import zipfile

import fmpy
import jsbsim
import numpy
from fmpy.fmi3 import FMU3Model, FMU3Slave, fmi3LogMessageCallback
from fmpy.validation import validate_fmu

programs, files = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
data = pathlib.Path(os.environ.get("PHUGOID_SHARED_DATA", "../shared/data")).resolve()

# Of both interfaces against our own flight, relative to the largest value of the channel (but at least 1e-3 of its SI unit).
SAME = 1e-9
# Of FMPy's solver, CVode with a relative tolerance of 1e-10, against Runge-Kutta steps of half a millisecond.
SOLVED = 1e-6
# Units of FMI 3.0 and how headers of our records end.
ENDINGS = {"rad": "rad", "rad/s": "rad_s", "rad/s2": "rad_s2", "m": "m", "m/s": "m_s", "m/s2": "m_s2", "N": "n", "Pa": "pa", "kg/m3": "kg_m3"}

INCREMENTS = {"dCm_alpha": -0.05, "dCL_alpha": 0.1, "dCm_q": -0.5}


def run(*arguments, fails=False):
    done = subprocess.run([programs / "phugoid", *map(str, arguments)], capture_output=True, text=True)
    if (done.returncode != 0) != fails:
        sys.exit(f"check-fmu: phugoid {' '.join(map(str, arguments))}: exit code {done.returncode}\n{done.stderr}")
    return done.stdout + done.stderr


def expect(holds, message):
    if not holds:
        sys.exit(f"check-fmu: {message}")


def flight(name, aircraft, condition, lateral):
    """Flies a scenario and gives the record of what was true, by header."""
    surfaces = ["elevator", "aileron", "rudder"] if lateral else ["elevator"]
    text = f"""name = "{name}"
duration = "8 s"
sample_rate = "100 Hz"
[aircraft]
{aircraft}
thrust = "engine"
[condition]
altitude = "{condition["altitude"]}"
speed = "{condition["speed"]}"
[increments]
"""
    text += "".join(f"{key} = {value}\n" for key, value in INCREMENTS.items())
    for start, surface in enumerate(surfaces, 1):
        text += f'[[manoeuvre]]\ntype = "3-2-1-1"\nsurface = "{surface}"\nstart = "{start} s"\nunit = "0.4 s"\namplitude = "1 deg"\n'
    scenario = files / f"{name}-scenario.toml"
    scenario.write_text(text)
    out = files / f"{name}-flight"
    shutil.rmtree(out, ignore_errors=True)
    run("simulate", scenario, "--out", out)
    with open(out / "truth.csv", newline="") as file:
        rows = list(csv.reader(file))
    columns = numpy.array(rows[1:], dtype=float).T
    return dict(zip(rows[0], columns))


def inputs(truth, description, staircase):
    """What the flight's surfaces and lever did: at the samples, or as steps for a solver that looks between them."""
    names = [v.name for v in description.modelVariables if v.causality == "input"]
    table = numpy.zeros(len(truth["time_s"]), dtype=[("time", float)] + [(name, float) for name in names])
    table["time"] = truth["time_s"]
    start = {v.name: float(v.start) for v in description.modelVariables if v.causality == "input"}
    for name in names:
        header = name if name == "throttle" else f"{name}_rad"
        table[name] = truth.get(header, start[name])
    if not staircase:
        return table
    changes = [k for k in range(1, len(table)) if any(table[name][k] != table[name][k - 1] for name in names)]
    kept = [table[0]]
    for k in changes:
        before = table[k - 1].copy()
        before["time"] = table["time"][k]
        kept += [before, table[k]]
    last = table[-1].copy()
    return numpy.array(kept + [last], dtype=table.dtype)


def worst(values, reference):
    """Largest difference over the largest value of the reference."""
    return float(numpy.max(numpy.abs(values - reference)) / max(numpy.max(numpy.abs(reference)), 1e-3))


def by_hand(fmu, description, truth, names):
    """Co-simulation step by step: inputs, then outputs, then the step, as the flight was recorded."""
    reference = {v.name: v.valueReference for v in description.modelVariables}
    folder = fmpy.extract(fmu)
    one = slave(description, folder, Messages())
    one.setFloat64([reference[name] for name in INCREMENTS], list(INCREMENTS.values()))
    one.enterInitializationMode()
    one.exitInitializationMode()
    table = inputs(truth, description, False)
    given = [reference[name] for name in table.dtype.names[1:]]
    wanted = [reference[name] for name in names]
    rows = []
    for k, row in enumerate(table):
        time = float(row["time"])
        one.setFloat64(given, [float(value) for value in list(row)[1:]])
        rows.append(one.getFloat64(wanted))
        if k + 1 < len(table):
            one.doStep(time, float(table["time"][k + 1]) - time)
    one.terminate()
    one.freeInstance()
    shutil.rmtree(folder, ignore_errors=True)
    return dict(zip(names, numpy.array(rows).T))


def check_simulations(fmu, truth):
    description = fmpy.read_model_description(fmu)
    outputs = [v for v in description.modelVariables if v.causality == "output"]
    states = [f"state.{v.name.removeprefix('state.')}" for v in description.modelVariables if v.name.startswith("state.")]
    rates = [f"der({state})" for state in states]
    common = dict(stop_time=8.0, start_values=dict(INCREMENTS), output_interval=0.01)

    headers = {v.name: v.name + ("" if v.unit not in ENDINGS else f"_{ENDINGS[v.unit]}") for v in outputs}
    headers = {name: header for name, header in headers.items() if header in truth}
    expect(len(headers) >= 20, f"{fmu.name}: only {list(headers)} can be compared")
    ours = by_hand(fmu, description, truth, [v.name for v in outputs] + states + rates)
    largest = 0.0
    for name, header in headers.items():
        difference = worst(ours[name], truth[header])
        expect(difference <= SAME, f"{fmu.name}: `{name}` of co-simulation is {difference:.2e} from the flight")
        largest = max(largest, difference)
    # FMPy's own loop reads outputs before it sets the inputs of the next step, so that only what follows from states is comparable.
    followed = [name for name in ["true_airspeed", "alpha", "beta", "phi", "theta", "psi", "p", "q", "r", "altitude", "north", "east", "mach"]]
    looped = fmpy.simulate_fmu(
        str(fmu), fmi_type="CoSimulation", input=inputs(truth, description, False), output=followed, **common
    )
    expect(len(looped) == len(truth["time_s"]), f"{fmu.name}: {len(looped)} rows, and the flight has {len(truth['time_s'])}")
    for name in followed:
        difference = worst(looped[name], truth[headers[name]])
        expect(difference <= SAME, f"{fmu.name}: `{name}` of FMPy's simulation is {difference:.2e} from the flight")
        largest = max(largest, difference)

    # Model exchange: the derivatives at the states of co-simulation, and FMPy's own solver.
    folder = fmpy.extract(fmu)
    model = FMU3Model(
        guid=description.guid, unzipDirectory=folder, modelIdentifier=description.modelExchange.modelIdentifier, instanceName="one"
    )
    model.instantiate()
    reference = {v.name: v.valueReference for v in description.modelVariables}
    model.setFloat64([reference[name] for name in INCREMENTS], list(INCREMENTS.values()))
    model.enterInitializationMode()
    model.exitInitializationMode()
    model.updateDiscreteStates()
    model.enterContinuousTimeMode()
    table = inputs(truth, description, False)
    x, dx = (numpy.zeros(len(states)) for _ in range(2))
    pointer = ctypes.POINTER(ctypes.c_double)
    derivatives = 0.0
    for k in range(0, len(table), 20):
        model.setTime(float(table["time"][k]))
        model.setFloat64([reference[name] for name in table.dtype.names[1:]], [float(value) for value in list(table[k])[1:]])
        x[:] = [ours[state][k] for state in states]
        model.setContinuousStates(x.ctypes.data_as(pointer), len(x))
        model.getContinuousStateDerivatives(dx.ctypes.data_as(pointer), len(dx))
        for header, rate in [("pdot_rad_s2", "der(state.p)"), ("qdot_rad_s2", "der(state.q)"), ("rdot_rad_s2", "der(state.r)")]:
            if header in truth:
                scale = max(numpy.max(numpy.abs(truth[header])), 1e-3)
                derivatives = max(derivatives, abs(dx[rates.index(rate)] - truth[header][k]) / scale)
    model.terminate()
    model.freeInstance()
    shutil.rmtree(folder, ignore_errors=True)
    expect(derivatives <= SAME, f"{fmu.name}: derivatives of model exchange are {derivatives:.2e} from the flight")

    watched = ["true_airspeed", "alpha", "theta", "q", "p", "r", "az", "altitude"]
    staircase = inputs(truth, description, True)
    solved = fmpy.simulate_fmu(
        str(fmu), fmi_type="ModelExchange", solver="CVode", relative_tolerance=1e-10, input=staircase, output=watched, **common
    )
    fine = fmpy.simulate_fmu(
        str(fmu), fmi_type="CoSimulation", input=inputs(truth, description, False), output=watched,
        **(common | {"start_values": INCREMENTS | {"integration_step": 0.0005}}),
    )
    # At a step of the input a solver writes the instant twice.
    at = {round(time, 6): k for k, time in enumerate(solved["time"])}
    rows = [at[round(time, 6)] for time in fine["time"]]
    solver = max(worst(solved[name][rows], fine[name]) for name in watched if name != "az")
    expect(solver <= SOLVED, f"{fmu.name}: model exchange is {solver:.2e} from co-simulation")
    print(
        f"  {fmu.name}: {len(headers)} channels of co-simulation within {largest:.1e} of the flight, derivatives of model exchange within "
        f"{derivatives:.1e}, CVode within {solver:.1e}"
    )


class Messages:
    """Collects what an FMU says."""

    def __init__(self):
        self.texts = []
        self.callback = fmi3LogMessageCallback(lambda _, status, category, message: self.texts.append(message.decode()))

    def said(self, *words):
        return any(all(word in text for word in words) for text in self.texts)


# FMPy changes the working directory of the process while it loads a library, and goes back to where it was: of two threads
# that load at once one can leave the process in the folder of the FMU, which is removed later.
LOADING = threading.Lock()


def slave(description, folder, messages):
    with LOADING:
        made = FMU3Slave(
            guid=description.guid, unzipDirectory=folder, modelIdentifier=description.coSimulation.modelIdentifier, instanceName="one"
        )
    made.instantiate(logMessage=messages.callback)
    return made


def refused(action):
    try:
        action()
    except Exception as error:  # FMPy says a failed instantiation by a plain one
        return str(error) or "refused"
    return None


def check_errors(fmu):
    description = fmpy.read_model_description(fmu)
    reference = {v.name: v.valueReference for v in description.modelVariables}
    folder = fmpy.extract(fmu)
    messages = Messages()
    one = slave(description, folder, messages)
    nan = float("nan")
    for name, value, word in [("elevator", nan, "finite"), ("throttle", 1.2, "between 0 and 1"), ("state.speed", -1.0, "positive"), ("alpha", 0.1, "computed")]:
        expect(refused(lambda: one.setFloat64([reference[name]], [value])), f"{name} = {value} is taken")
        expect(messages.said(f"`{name}`", word), f"{name} = {value}: no message, but {messages.texts}")
    expect(refused(lambda: one.getFloat64([4711])) and messages.said("4711"), "an unknown reference is taken")
    expect(refused(lambda: one.doStep(0.0, 0.01)) and messages.said("fmi3DoStep", "instantiated"), "a step before the start is taken")
    one.enterInitializationMode()
    one.exitInitializationMode()
    expect(refused(lambda: one.doStep(5.0, 0.01)) and messages.said("steps follow each other"), "a step from elsewhere is taken")
    for size in [nan, 0.0, -1.0, 1e9]:
        expect(refused(lambda: one.doStep(0.0, size)), f"a step of {size} is taken")

    # Null pointers, given by hand.
    library, handle = one.dll, ctypes.c_void_p(one.component if isinstance(one.component, int) else one.component.value)
    library.fmi3GetFloat64.restype = ctypes.c_int
    expect(library.fmi3GetFloat64(handle, None, ctypes.c_size_t(3), None, ctypes.c_size_t(3)) == 3, "null pointers are followed")
    expect(library.fmi3GetFloat64(None, None, ctypes.c_size_t(0), None, ctypes.c_size_t(0)) == 3, "a null instance is followed")
    expect(messages.said("null"), "no message about a null pointer")

    # The state, kept, written down, and gone back to.
    def step():
        one.doStep(step.time, 0.01)
        step.time += 0.01
        return one.getFloat64([reference["q"], reference["state.alpha"]])

    step.time = 0.0
    one.setFloat64([reference["elevator"]], [-0.1])
    for _ in range(10):
        step()
    kept, time = one.getFMUState(), step.time
    written = one.serializeFMUState(kept)
    first = [step() for _ in range(20)]
    one.setFMUState(kept)
    step.time = time
    expect([step() for _ in range(20)] == first, "a state that was kept leads elsewhere")
    again = one.deserializeFMUState(written)
    one.setFMUState(again)
    step.time = time
    expect([step() for _ in range(20)] == first, "a state that was written down leads elsewhere")
    expect(refused(lambda: one.deserializeFMUState(written[:-3])), "half a state is taken")
    one.freeFMUState(kept)
    one.freeFMUState(again)
    # Far beyond the data: a warning, and the simulation goes on until it diverges, which is an error.
    one.setFloat64([reference["elevator"]], [-1.5])
    step()
    expect(messages.said("`elevator`", "extrapolated"), f"no warning beyond the limits: {messages.texts}")
    one.reset()
    values = one.getFloat64([reference["elevator"]])
    start = next(v.start for v in description.modelVariables if v.name == "elevator")
    expect(values == [float(start)], "a reset does not lead back to the start")

    # Instances beside each other, in threads with a quarter of a megabyte of stack.
    def fly(elevator, out):
        made = slave(description, folder, Messages())
        made.enterInitializationMode()
        made.setFloat64([reference["elevator"]], [elevator])
        made.exitInitializationMode()
        for k in range(200):
            made.doStep(k * 0.01, 0.01)
        out.append(made.getFloat64([reference["alpha"], reference["CZ"]]))
        made.terminate()
        made.freeInstance()

    alone, threads, results = [], [], []
    for k in range(4):
        fly(float(start) + 0.002 * k, alone)
    threading.stack_size(256 * 1024)
    for k in range(4):
        results.append([])
        threads.append(threading.Thread(target=fly, args=(float(start) + 0.002 * k, results[-1])))
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    expect([result[0] for result in results if result] == alone, f"instances in threads give {results}, and one by one {alone}")
    threading.stack_size(0)
    one.freeInstance()

    # Resources that are broken.
    resources = pathlib.Path(folder) / "resources"
    whole = {path: path.read_bytes() for path in resources.rglob("*") if path.is_file()}
    main = resources / "aircraft.toml"

    def broken(what, *words):
        messages = Messages()
        expect(refused(lambda: slave(description, folder, messages)), f"{what} is taken")
        expect(messages.said(*words), f"{what}: the message is {messages.texts}")
        for path, content in whole.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)

    main.unlink()
    broken("no description", "aircraft.toml", "cannot be read")
    main.write_bytes(whole[main][:60])
    broken("half a description", "aircraft.toml")
    main.write_bytes(whole[main].replace(b"format = 1", b"format = 2"))
    broken("another format", "format 2")
    main.write_bytes(b"format = 1\nx = " + b"[" * 100_000)
    broken("a deep description", "aircraft.toml")
    main.write_bytes(b"\xff\xfe\x00" * 100)
    broken("a description in no UTF-8", "aircraft.toml")
    main.write_bytes(whole[main].replace(b"[aircraft]\n", b"[aircraft]\nfoo = 1\n"))
    broken("an unknown key", "foo")
    main.write_bytes(whole[main].replace(b"[state]\nspeed = ", b"[state]\nspeed = nan # "))
    broken("a state that is no number", "finite")
    main.write_bytes(b"".join(line for line in whole[main].splitlines(True) if not line.startswith((b"file =", b"type ="))))
    broken("no aircraft", "`file`")
    for path in whole:
        if path != main:
            path.write_bytes(whole[path][: len(whole[path]) // 2])
            broken(f"half of {path.name}", "aircraft")
            path.unlink()
            broken(f"no {path.name}", "aircraft")
    messages = Messages()
    other = FMU3Slave(
        guid="{other}", unzipDirectory=folder, modelIdentifier=description.coSimulation.modelIdentifier, instanceName="one"
    )
    expect(refused(lambda: other.instantiate(logMessage=messages.callback)) and messages.said("token"), "another token is taken")
    shutil.rmtree(folder, ignore_errors=True)
    print(f"  {fmu.name}: what is wrong is refused with a message, instances in threads are apart, states come back")


def main():
    files.mkdir(parents=True, exist_ok=True)
    package = pathlib.Path(jsbsim.__file__).parent
    jet = files / "jet.toml"
    jet.write_text(run("estimate", "--show-model", "hfb320"))
    # An aircraft of JSBSim with a model file of increments, below a folder of their own.
    c182 = package / "aircraft" / "c182"
    aircraft = [
        ("f16", ["--aircraft", "f16", "--cg", "0.30"], 'type = "f16"\ncg = 0.30', {"altitude": "20000 ft", "speed": "675 ft/s"}, True),
        ("jet", ["--aircraft", jet], f'file = "{jet}"', {"altitude": "4300 m", "speed": "104.67 m/s"}, False),
        ("c182", ["--aircraft", c182], f'file = "{c182}"', {"altitude": "5000 ft", "speed": "120 kt"}, True),
    ]
    # Increments to it, in a model file that names it as its base from another folder.
    (files / "base" / "aircraft").mkdir(parents=True, exist_ok=True)
    for folder in ["aircraft/c182", "engine"]:
        shutil.copytree(package / folder, files / "base" / folder, dirs_exist_ok=True)
    (files / "base" / "models").mkdir(exist_ok=True)
    increments = files / "base" / "models" / "c182.toml"
    increments.write_text("""axes = ["longitudinal"]
base = "../aircraft/c182"
[aircraft]
air_density = "standard_atmosphere"
thrust = "trim"
reference_speed = "120 kt"
[coefficients]
Cm = ["alpha"]
[parameters]
dCm_alpha = { start = -0.1, bounds = [-1, 1] }
[reference]
altitude = "5000 ft"
""")
    aircraft.append(("base", ["--aircraft", increments], f'file = "{increments}"', {"altitude": "5000 ft", "speed": "120 kt"}, True))
    s119, gtm = data / "checks" / "daveml_s119", data / "gtm"
    if s119.is_dir():
        further = [s119 / "F16_inertia.dml", s119 / "F16_prop.dml"]
        options = [word for file in further for word in ("--with", file)] + ["--property", "vrsPositionOfCM=30"]
        with_files = ", ".join(f'"{file}"' for file in further)
        lines = f'file = "{s119 / "F16_aero.dml"}"\nwith = [{with_files}]\nproperties = {{ vrsPositionOfCM = 30 }}'
        condition = {"altitude": "1000 ft", "speed": "502 ft/s"}
        aircraft.append(("s119", ["--aircraft", s119 / "F16_aero.dml", *options], lines, condition, True))
    if gtm.is_dir():
        lines = f'file = "{gtm}"\ndamaged = "left-stabiliser-off"'
        condition = {"altitude": "300 m", "speed": "40 m/s"}
        aircraft.append(("gtm", ["--aircraft", gtm, "--damaged", "left-stabiliser-off"], lines, condition, True))
    if not (s119.is_dir() and gtm.is_dir()):
        print(f"check-fmu: skipped: no aircraft of {data} (set PHUGOID_SHARED_DATA)")

    for name, options, lines, condition, lateral in aircraft:
        fmu = files / f"{name}.fmu"
        at = ["--altitude", condition["altitude"].replace(" ", ""), "--speed", condition["speed"].replace(" ", "")]
        run("export-fmu", *options, *at, "--out", fmu)
        before = fmu.read_bytes()
        run("export-fmu", *options, *at, "--out", fmu)
        expect(fmu.read_bytes() == before, f"{name}: the same aircraft makes two FMUs")
        with zipfile.ZipFile(fmu) as archive:
            for entry in archive.namelist():
                expect(str(files).encode() not in archive.read(entry) or entry.startswith("binaries/"), f"{name}: {entry} tells places")
                expect(str(package).encode() not in archive.read(entry) or entry.startswith("binaries/"), f"{name}: {entry} tells places")
        problems = validate_fmu(str(fmu))
        expect(not problems, f"{name}: FMPy's validation finds {problems}")
        check_simulations(fmu, flight(name, lines, condition, lateral))
    check_errors(files / "f16.fmu")
    check_errors(files / "c182.fmu")

    # What cannot become an FMU.
    at = ["--altitude", "6000m", "--speed", "200m/s", "--out", files / "none.fmu"]
    said = run("export-fmu", *at, "--library", jet, fails=True)
    expect("phugoid-fmi" in said, f"a library that is none: {said}")
    with tempfile.TemporaryDirectory() as elsewhere:
        alone = shutil.copy(programs / "phugoid", elsewhere)
        done = subprocess.run([alone, "export-fmu", *map(str, at)], capture_output=True, text=True)
        expect(done.returncode == 3 and "cargo build" in done.stderr, f"without a library: {done.stderr}")
    print("check-fmu: all hold")


main()
