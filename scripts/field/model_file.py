"""The model file that a stranger writes: geometry, mass, inertia, terms, and guesses from a textbook."""

from truth import TERMS

WHICH = {"longitudinal": '"longitudinal"', "lateral": '"lateral"', "six": '"longitudinal", "lateral"'}
WORDS = {"0": "1", "p": "p_hat", "q": "q_hat", "r": "r_hat", "alpha2": "alpha^2"}


def write(path, sim, spec, axes: str, thrust: str = '{ channel = "thrust" }') -> None:
    """Writes the model file of `axes` with this thrust. It knows nothing of the truth: starts are textbook values of the class."""
    cl_alpha, cm_alpha, cm_q, cm_elevator = spec.guess
    guess = {
        "CL_0": (0.3, 0.4), "CL_alpha": (cl_alpha, 2.5), "CL_q": (5.0, 20.0), "CL_elevator": (0.4, 0.6),
        "CD_0": (0.03, 0.05), "CD_alpha": (0.1, 0.5), "CD_alpha2": (1.0, 5.0),
        "Cm_0": (0.0, 0.15), "Cm_alpha": (cm_alpha, 1.5), "Cm_q": (cm_q, 20.0), "Cm_elevator": (cm_elevator, 1.5),
        "CY_0": (0.0, 0.05), "CY_beta": (-0.6, 0.8), "CY_p": (0.0, 0.5), "CY_r": (0.2, 0.8), "CY_rudder": (0.15, 0.3),
        "Cl_0": (0.0, 0.01), "Cl_beta": (-0.08, 0.15), "Cl_p": (-0.45, 0.5), "Cl_r": (0.1, 0.3), "Cl_aileron": (-0.15, 0.2), "Cl_rudder": (0.01, 0.05),
        "Cn_0": (0.0, 0.01), "Cn_beta": (0.1, 0.15), "Cn_p": (-0.03, 0.2), "Cn_r": (-0.15, 0.3), "Cn_aileron": (0.0, 0.05), "Cn_rudder": (-0.07, 0.1),
    }
    inertia = sim.inertia()
    lines = [
        f'name = "{spec.name} ({spec.stands_for})"',
        f'axes = [{WHICH[axes]}]',
        'input = "interpolated"',
        "",
        "[aircraft]",
        f'mass = "{sim.mass:.6g} kg"',
        f'iyy = "{inertia["iyy"]:.6g} kg*m^2"',
    ]
    if axes != "longitudinal":
        lines += [f'{k} = "{inertia[k] + 0.0:.6g} kg*m^2"' for k in ("ixx", "izz", "ixz")]
    lines += [
        f'wing_area = "{sim.wing_area:.6g} m^2"',
        f'mean_chord = "{sim.chord:.6g} m"',
        f'wing_span = "{sim.span:.6g} m"',
        f"thrust = {thrust}",
        'air_density = { channel = "air_density" }' if spec.density == "channel" else 'air_density = "standard_atmosphere"',
        "",
        "[coefficients]",
    ]
    for coefficient, terms in TERMS[axes].items():
        lines.append(f"{coefficient} = [{', '.join(chr(34) + WORDS.get(t, t) + chr(34) for t in terms)}]")
    lines += ["", "[parameters]"]
    for coefficient, terms in TERMS[axes].items():
        for term in terms:
            start, prior = guess[f"{coefficient}_{term}"]
            lines.append(f"{coefficient}_{term} = {{ start = {start}, prior_std = {prior} }}")
    path.write_text("\n".join(lines) + "\n")
