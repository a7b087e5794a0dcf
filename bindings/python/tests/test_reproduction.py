"""Cases of the thesis from Python, and plants of one's own."""

import math
from pathlib import Path

import numpy as np
import phugoid
import pytest

SCENARIOS = Path(__file__).parents[3] / "scenarios"


class Spring(phugoid.Plant):
    """The plant of scenarios/own-plant.toml."""

    title = "A plant of one's own: a mass on a spring, with drag"
    states = ["x", "v"]
    parameters = {
        "k": {"truth": 16.0, "lower": 8.0, "upper": 32.0, "start": 12.0, "lambda": 10.0},
        "c": {"truth": 3.0, "lower": 1.5, "upper": 6.0, "start": 4.0, "lambda": 5.0},
    }
    constants = {"m": 2.0}
    start = {"x": 0.05}
    input = {"type": "sine", "amplitude": 10.0, "frequency": "2 rad/s"}
    duration_s, sample_time_s, eta = 6.0, 0.001, 0.001

    def rates(self, s):
        return {"x": s.v, "v": (s.u - s.k * s.x - s.c * s.v * abs(s.v)) / s.m}


@pytest.fixture(scope="module")
def spring():
    return phugoid.reproduce(Spring())


def test_a_plant_in_python_is_the_plant_of_the_case_file(spring):
    of_file = phugoid.reproduce(SCENARIOS / "own-plant.toml")
    assert of_file.id == "own-plant" and spring.id == "Spring"
    assert spring.outcomes == of_file.outcomes
    assert spring.to_dict()["golden"] == of_file.to_dict()["golden"]


def test_the_flagship_finds_what_the_plant_was_simulated_with(spring):
    frame = spring.to_pandas()
    flagship = frame[frame.role == "flagship"].set_index("parameter")
    assert list(flagship.behaviour) == ["converges", "converges"]
    assert abs(flagship.end["k"] - 16.0) < 0.05 * 16.0 and abs(flagship.end["c"] - 3.0) < 0.05 * 3.0
    # It is not found because it is told: another truth is found too.
    class Softer(Spring):
        parameters = {**Spring.parameters, "k": {**Spring.parameters["k"], "truth": 20.0}}

    softer = phugoid.reproduce(Softer()).to_pandas()
    assert abs(softer[(softer.role == "flagship") & (softer.parameter == "k")].end.iloc[0] - 20.0) < 1.0


def test_functions_of_numpy_become_those_of_formulas():
    class Pendulum(Spring):
        states = ["phi", "w"]
        parameters = {"k": Spring.parameters["k"]}
        start = {}

        def rates(self, s):
            return {"phi": s.w, "w": (s.u - s.k * np.sin(s.phi)) / s.m - np.float64(0.5) * s.w * np.exp(-s.t)}

        def outputs(self, s):
            return {"angle": 2 * s.phi, "rate": s.w}

    case = Pendulum().case()["plant"]
    assert case["rates"] == {"phi": "w", "w": "(u - k*sin(phi))/m - 0.5*w*exp(-t)"}
    assert case["outputs"] == {"angle": "2*phi", "rate": "w"}
    found = phugoid.reproduce(Pendulum()).to_pandas()
    flagship = found[found.role == "flagship"].iloc[0]
    assert flagship.behaviour == "converges" and abs(flagship.end - 16.0) < 0.8


def test_formulas_have_the_value_of_the_expression():
    """Every way to write an expression, against plain numbers."""
    expressions = [
        lambda s: -s.x**2 + (-s.x) ** 2 * -s.k - (s.x - (s.v - s.k)),
        lambda s: 3 - s.x / (s.v / s.k) * 2.5 + 2 ** (s.x - 1) / (-s.v),
        lambda s: np.maximum(s.x, 1.25) * np.minimum(2, s.v) - np.square(s.k) + np.float64(1e-7) * s.x,
        lambda s: np.sqrt(abs(s.x - s.v)) + np.log(s.k) * np.tanh(s.x) - np.arctan(s.v) + np.sinh(s.x) / np.cosh(s.v),
        lambda s: +s.x - -1.5 * s.v + (s.x * (s.v * s.k)) / (s.k / s.v),
    ]
    functions = {name: getattr(math, name) for name in ("sin", "exp", "sqrt", "tanh", "atan", "sinh", "cosh")}
    functions.update(ln=math.log, abs=abs)
    symbols = phugoid.Symbols(["x", "v", "k"])
    random = np.random.default_rng(4)

    class Numbers:
        pass

    for expression in expressions:
        text = str(expression(symbols)).replace("^", "**")
        for _ in range(50):
            numbers = Numbers()
            numbers.__dict__.update(zip("xvk", random.uniform(0.1, 3.0, 3).tolist()))
            expected = expression(numbers)
            assert abs(eval(text, functions, numbers.__dict__) - expected) <= 1e-12 * max(1.0, abs(expected)), text


@pytest.mark.parametrize(
    ("rate", "words"),
    [
        (lambda s: s.v if s.x > 0 else -s.v, "numpy.maximum"),
        (lambda s: math.sin(s.x), "functions of numpy"),
        (lambda s: 0 if s.x == 0 else s.k, "symbols in place of numbers"),
        (lambda s: max(s.x, 0), "numpy.maximum"),
        (lambda s: np.floor(s.x) * s.k, "numpy.floor is no function"),
        (lambda s: s.k * float("nan"), "finite numbers"),
        (lambda s: s.k * np.array([1.0, 2.0]), "numbers and symbols"),
        (lambda s: "k*x", "numbers and symbols, found str"),
        (lambda s: s.k * np.random.default_rng().random(), "nothing random"),
    ],
)
def test_what_cannot_become_a_formula_is_refused(rate, words):
    class Bad(Spring):
        def rates(self, s):
            return {"x": s.v, "v": rate(s)}

    with pytest.raises(phugoid.PhugoidError, match=words):
        phugoid.reproduce(Bad())


def test_what_the_case_lacks_is_named():
    class Lacking(Spring):
        def rates(self, s):
            return {"x": s.v}

    class Long(Spring):
        def rates(self, s):
            rate = s.k
            for _ in range(1000):
                rate = rate * s.x + rate
            return {"x": s.v, "v": rate}

    class Squared(Spring):
        def rates(self, s):
            return {"x": s.v, "v": s.u - s.k**2 * s.x - s.c}

    for plant, words in [(Lacking, "`plant.rates.v` is missing"), (Long, "more than 1000 characters"), (Squared, "is not linear")]:
        with pytest.raises(phugoid.PhugoidError, match=words):
            phugoid.reproduce(plant())
    with pytest.raises(AttributeError, match="the plant has no `y`"):
        phugoid.Symbols(["x"]).y  # noqa: B018
    with pytest.raises(NotImplementedError, match="rates"):
        phugoid.reproduce(type("None_", (Spring,), {"rates": phugoid.Plant.rates})())
    with pytest.raises(phugoid.PhugoidError, match="values are words, finite numbers"):
        phugoid.reproduce({"title": float("nan")})
    with pytest.raises(phugoid.PhugoidError, match="Did you mean `first-order/"):
        phugoid.reproduce("first-order/l")


def test_cases_of_the_thesis_are_listed_run_and_drawn():
    assert phugoid.cases()["first-order/1"]
    case = phugoid.reproduce("first-order/1")
    assert {outcome["role"] for outcome in case.outcomes} >= {"flagship", "published"}
    curves = case.curves(case.charts[0])
    time, values = next(iter(curves.values()))
    assert time.shape == values.shape and time.size > 10
    figure = case.plot()
    assert figure.axes[0].lines and figure.axes[-1].get_xlabel().startswith("Time")
    html = case._repr_html_()
    assert "first-order/1" in html and "converges" in html
    with pytest.raises(phugoid.PhugoidError, match="has no figure `none`"):
        case.plot("none")


def test_the_text_of_a_case_with_other_numbers_is_not_the_case_of_the_thesis():
    text = (SCENARIOS / "thesis" / "first-order-1.toml").read_text(encoding="utf-8")
    assert "changed: not the case first-order/1" in phugoid.reproduce(text.replace("seed", "# seed") + "\n# mine\n").title
