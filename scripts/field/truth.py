"""The true derivatives of a flight: JSBSim's own coefficients, fitted by the terms of the model file.

What any estimator with these terms can find at best is the least-squares fit of the exact coefficients on the exact
regressors over the samples of the flight. Its share of the coefficient's variation says whether the flight shows it."""

import numpy as np

TERMS = {
    "longitudinal": {
        "CL": ("0", "alpha", "q", "elevator"),
        "CD": ("0", "alpha", "alpha2"),
        "Cm": ("0", "alpha", "q", "elevator"),
    },
    "lateral": {
        "CY": ("0", "beta", "p", "r", "rudder"),
        "Cl": ("0", "beta", "p", "r", "aileron", "rudder"),
        "Cn": ("0", "beta", "p", "r", "aileron", "rudder"),
    },
}
TERMS["six"] = TERMS["longitudinal"] | TERMS["lateral"]
# From this share on a derivative counts as well excited.
WELL_EXCITED = 0.05


def regressors(channels: dict, chord: float, span: float, trim_speed: float) -> dict:
    """The variables of the terms, normalised as in a model file; the speed by that of the trim.
    Rates are those relative to the air, which turbulence may turn."""
    v = channels["tas"]
    return {
        "0": np.ones(len(v)),
        "alpha": channels["alpha"],
        "alpha2": channels["alpha"] ** 2,
        "beta": channels["beta"],
        "p": channels["p_air"] * span / (2 * v),
        "q": channels["q_air"] * chord / (2 * v),
        "r": channels["r_air"] * span / (2 * v),
        "elevator": channels["elevator"],
        "aileron": channels["aileron"],
        "rudder": channels["rudder"],
        "V": v / trim_speed,
        "beta2": channels["beta"] ** 2,
        "abs_elevator": np.abs(channels["elevator"]),
    }


def fit(coefficients: dict, x: dict, axes: str, rows: np.ndarray, rate_hz: float, added: dict | None = None) -> tuple[dict, dict]:
    """The truth of the samples `rows`, `rate_hz` per second: by parameter its value, its share of the variation of its
    coefficient, how much of its regressor the other terms leave (0: none), and how far the structure determines it: the
    standard error of the value that what the terms do not explain would make; and by coefficient the part of the variation
    that the terms explain. `added` are terms that the aircraft has and the model file does not, by the name of the
    parameter."""
    parameters, explained = {}, {}
    for coefficient, terms in TERMS[axes].items():
        terms += tuple(name.split("_", 1)[1] for name in added or {} if name.split("_", 1)[0] == coefficient)
        a = np.column_stack([x[t][rows] for t in terms])
        y = coefficients[coefficient][rows]
        scale = np.abs(a).max(axis=0)
        scale[scale == 0] = 1.0
        solution = np.linalg.lstsq(a / scale, y, rcond=None)[0] / scale
        residual = y - a @ solution
        variance = ((y - y.mean()) ** 2).sum()
        explained[coefficient] = float(1 - (residual**2).sum() / variance) if variance > 0 else 1.0
        structure = _structure_std(a, residual, int(2 * rate_hz))
        moved = np.abs(solution) * a.std(axis=0)
        total = moved.sum()
        for k, term in enumerate(terms):
            others = np.delete(a, k, axis=1)
            left = a[:, k] - others @ np.linalg.lstsq(others, a[:, k], rcond=None)[0]
            spread = a[:, k].std()
            share = float(moved[k] / total) if total > 0 else 0.0
            parameters[f"{coefficient}_{term}"] = {
                "value": float(solution[k]),
                "share": share,
                "own": float(left.std() / spread) if spread > 0 else 0.0,
                "structure_std": float(structure[k]),
                "well_excited": term != "0" and share > WELL_EXCITED,
            }
    return parameters, explained


def _structure_std(a: np.ndarray, residual: np.ndarray, lags: int) -> np.ndarray:
    """Standard errors of the least squares for residuals that are correlated over two seconds (W. K. Newey, K. D. West,
    Econometrica 55, 1987, with Bartlett's weights)."""
    scale = np.abs(a).max(axis=0)
    scale[scale == 0] = 1.0
    a = a / scale
    moments = a * residual[:, None]
    middle = moments.T @ moments
    for k in range(1, min(lags, len(a) - 1)):
        cross = moments[k:].T @ moments[:-k]
        middle += (1 - k / lags) * (cross + cross.T)
    inverse = np.linalg.pinv(a.T @ a)
    return np.sqrt(np.maximum(np.diag(inverse @ middle @ inverse), 0.0)) / scale
