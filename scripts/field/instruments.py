"""From what happened to what a recorder writes: lags, noise, outliers, missing values, gaps, units, digits."""

import math

import numpy as np

FT = 0.3048
KT = 1852 / 3600
G = 9.80665
DEGREE = math.pi / 180

NOISE = {
    "tas": "tas", "alpha": "vane", "beta": "vane", "phi": "attitude", "theta": "attitude", "p": "rate", "q": "rate", "r": "rate",
    "ax": "acceleration", "ay": "acceleration", "az": "acceleration", "altitude": "altitude",
    "elevator": "surface", "aileron": "surface", "rudder": "surface",
}
# name in the file, SI per unit, digits, by the units of the recorder.
COLUMNS = {
    "si": {
        "tas": ("true_airspeed_m_s", 1, 3), "angle": ("rad", 1, 6), "rate": ("rad_s", 1, 6), "acceleration": ("m_s2", 1, 4), "altitude": ("altitude_m", 1, 2),
    },
    "degrees": {
        "tas": ("tas_m_s", 1, 3), "angle": ("deg", DEGREE, 4), "rate": ("deg_s", DEGREE, 4), "acceleration": ("m_s2", 1, 4), "altitude": ("altitude_m", 1, 2),
    },
    "us": {
        "tas": ("tas_kt", KT, 3), "angle": ("deg", DEGREE, 4), "rate": ("deg_s", DEGREE, 4), "acceleration": ("g", G, 5), "altitude": ("altitude_ft", FT, 1),
    },
}
CLASS = {"alpha": "angle", "beta": "angle", "phi": "angle", "theta": "angle", "elevator": "angle", "aileron": "angle", "rudder": "angle",
         "p": "rate", "q": "rate", "r": "rate", "ax": "acceleration", "ay": "acceleration", "az": "acceleration", "tas": "tas", "altitude": "altitude"}
ORDER = {
    "six": ("tas", "alpha", "beta", "phi", "theta", "p", "q", "r", "ax", "ay", "az", "elevator", "aileron", "rudder", "altitude", "density", "qbar", "thrust"),
    "longitudinal": ("tas", "alpha", "theta", "q", "ax", "az", "elevator", "altitude", "density", "qbar", "thrust"),
    "lateral": ("tas", "alpha", "beta", "phi", "theta", "p", "q", "r", "ax", "ay", "az", "elevator", "aileron", "rudder", "altitude", "density", "qbar", "thrust"),
}


def lag(signal: np.ndarray, tau: float, step: float) -> np.ndarray:
    """A lag of the first order, exact for a signal that is straight between two samples."""
    a = math.exp(-step / tau)
    b1 = 1 - tau / step * (1 - a)
    b0 = (1 - a) - b1
    out = np.empty(len(signal))
    out[0] = now = signal[0]
    for k in range(1, len(signal)):
        now = a * now + b0 * signal[k - 1] + b1 * signal[k]
        out[k] = now
    return out


def record(flown, plan, spec, rng) -> tuple[np.ndarray, dict, dict]:
    """What the recorder wrote: times (s), columns in SI (missing values are NaN), and the noise of each (one sigma)."""
    options = plan.instruments
    step = flown.time[1] - flown.time[0]
    every = int(round(1 / plan.rate_hz / step))
    picked = np.arange(0, len(flown.time), every)
    columns, noise = {}, {}
    for name in ORDER[plan.axes]:
        if name == "thrust" and (plan.gliding or plan.propeller or plan.whole):
            continue
        signal = flown.channels[name]
        tau = options.get("lags", {}).get(name, options.get("common_lag", 0.0))
        if tau > 0:
            signal = lag(signal, tau, step)
        values = signal[picked].copy()
        if name == "density":
            noise[name] = 0.0005 * values.mean()
        elif name == "qbar":
            noise[name] = 0.002 * values.mean()
        elif name == "thrust":
            noise[name] = 0.0
        else:
            noise[name] = spec.sheet[NOISE[name]] * options.get("noise_of", {}).get(name, 1.0)
        values += noise[name] * rng.standard_normal(len(values))
        columns[name] = values
    time = flown.time[picked]
    for name in ("tas", "alpha", "beta", "theta", "phi", "q", "ax", "az", "ay"):
        if name not in columns:
            continue
        n = len(time)
        if options.get("outliers"):
            hit = rng.random(n) < options["outliers"]
            columns[name][hit] += rng.choice([-1, 1], hit.sum()) * rng.uniform(15, 60, hit.sum()) * noise[name]
        if options.get("missing"):
            columns[name][rng.random(n) < options["missing"]] = math.nan
    keep = np.ones(len(time), bool)
    for start, end in options.get("gaps", ()):
        keep &= ~((time >= start) & (time < end))
    if options.get("lost_rows"):
        keep &= rng.random(len(time)) >= options["lost_rows"]
        keep[0] = True
    return time[keep], {k: v[keep] for k, v in columns.items()}, noise


def write_csv(path, time, columns, spec) -> None:
    """The file of a stranger: units in the header, as many digits as the recorder has."""
    table = COLUMNS[spec.units]
    headers, texts = ["time_s"], [[f"{t:.4f}" for t in time]]
    for name, values in columns.items():
        if name == "density":
            if spec.density != "channel":
                continue
            header, unit, digits = "air_density_kg_m3", 1, 6
        elif name == "qbar":
            header, unit, digits = "dynamic_pressure_pa", 1, 2
        elif name == "thrust":
            header, unit, digits = "thrust_n", 1, 2
        else:
            kind = CLASS[name]
            suffix, unit, digits = table[kind]
            header = suffix if kind in ("tas", "altitude") else f"{name}_{suffix}"
        headers.append(header)
        texts.append(["" if math.isnan(v) else f"{v / unit:.{digits}f}" for v in values])
    with open(path, "w", newline="\n") as file:
        file.write(",".join(headers) + "\n")
        file.writelines(",".join(row) + "\n" for row in zip(*texts))
