"""A plant of one's own for the laws of the thesis: its equations as Python methods, which become formulas.

The methods are called once, with symbols in place of numbers. What they return are the formulas of a case file, so that the
simulation and the estimators have exact derivatives and never call Python.
"""

from __future__ import annotations

import math
from typing import Any, Callable, Iterable, Mapping, NoReturn, Optional, Sequence, Union

import numpy as np

from ._phugoid import PhugoidError

#: The longest formula that is read, characters.
_MOST_CHARACTERS = 1000

#: What numpy calls the functions of formulas.
_FUNCTIONS = {
    "sin": "sin",
    "cos": "cos",
    "tan": "tan",
    "arcsin": "asin",
    "arccos": "acos",
    "arctan": "atan",
    "sinh": "sinh",
    "cosh": "cosh",
    "tanh": "tanh",
    "exp": "exp",
    "log": "ln",
    "sqrt": "sqrt",
    "absolute": "abs",
    "fabs": "abs",
}

# How closely the outermost part of a formula binds.
_SUM, _PRODUCT, _POWER, _ATOM = range(4)

Number = Union[int, float, "np.floating[Any]", "np.integer[Any]"]


class Formula:
    """A number that is not known yet: a state, a parameter, a constant, the input, the time, or what was computed of them.

    Formulas know ``+ - * / **``, ``abs``, ``np.sin``, ``np.cos``, ``np.tan``, ``np.arcsin``, ``np.arccos``, ``np.arctan``,
    ``np.sinh``, ``np.cosh``, ``np.tanh``, ``np.exp``, ``np.log``, ``np.sqrt``, ``np.maximum`` and ``np.minimum``.
    """

    __slots__ = ("_binds", "_text")
    #: A formula is equal to nothing, and so no key of a dictionary.
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, text: str, binds: int = _ATOM) -> None:
        if len(text) > _MOST_CHARACTERS:
            raise PhugoidError(
                f"a formula of the plant has more than {_MOST_CHARACTERS} characters: {text[:60]} ... A loop or a repeated "
                "expression makes it long; shorten the equations, or make a constant of what has no variable in it"
            )
        self._text = text
        self._binds = binds

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return f"<Formula {self._text}>"

    def _within(self, binds: int) -> str:
        return self._text if self._binds >= binds else f"({self._text})"

    def __add__(self, other: Any) -> "Formula":
        return _joined(self, other, " + ", _SUM, _SUM, _PRODUCT)

    def __radd__(self, other: Any) -> "Formula":
        return _joined(other, self, " + ", _SUM, _SUM, _PRODUCT)

    def __sub__(self, other: Any) -> "Formula":
        return _joined(self, other, " - ", _SUM, _SUM, _PRODUCT)

    def __rsub__(self, other: Any) -> "Formula":
        return _joined(other, self, " - ", _SUM, _SUM, _PRODUCT)

    def __mul__(self, other: Any) -> "Formula":
        return _joined(self, other, "*", _PRODUCT, _PRODUCT, _POWER)

    def __rmul__(self, other: Any) -> "Formula":
        return _joined(other, self, "*", _PRODUCT, _PRODUCT, _POWER)

    def __truediv__(self, other: Any) -> "Formula":
        return _joined(self, other, "/", _PRODUCT, _PRODUCT, _POWER)

    def __rtruediv__(self, other: Any) -> "Formula":
        return _joined(other, self, "/", _PRODUCT, _PRODUCT, _POWER)

    def __pow__(self, other: Any) -> "Formula":
        return _joined(self, other, "^", _POWER, _ATOM, _ATOM)

    def __rpow__(self, other: Any) -> "Formula":
        return _joined(other, self, "^", _POWER, _ATOM, _ATOM)

    def __neg__(self) -> "Formula":
        return Formula(f"-{self._within(_POWER)}", _SUM)

    def __pos__(self) -> "Formula":
        return self

    def __abs__(self) -> "Formula":
        return Formula(f"abs({self._text})")

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **keywords: Any) -> Any:
        name = ufunc.__name__
        single = all(isinstance(value, Formula) or np.ndim(value) == 0 for value in inputs)
        if method == "__call__" and not keywords and single:
            if name in _FUNCTIONS and len(inputs) == 1:
                return Formula(f"{_FUNCTIONS[name]}({self._text})")
            if name in _OPERATIONS:
                return _OPERATIONS[name](*inputs)
        raise PhugoidError(
            f"numpy.{name} is no function of a formula: there are + - * / **, abs and numpy's {', '.join(_FUNCTIONS)}, maximum and "
            "minimum, of single numbers"
        )

    def _no_number(self, *_: Any) -> NoReturn:
        raise PhugoidError(
            "the equations of a plant are called once, with symbols in place of numbers, and become formulas: `if`, comparisons, "
            "float() and the functions of `math` need a number. Take the functions of numpy, such as numpy.sin, and numpy.maximum "
            "or numpy.minimum in place of a comparison"
        )

    __bool__ = __float__ = __int__ = __index__ = _no_number
    __lt__ = __le__ = __gt__ = __ge__ = __iter__ = _no_number
    __eq__ = __ne__ = _no_number


def _formula(value: Any) -> Formula:
    """A number or a formula as a formula; anything else is refused."""
    if isinstance(value, Formula):
        return value
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, float, np.floating, np.integer)):
        raise PhugoidError(f"a formula is made of numbers and symbols, found {type(value).__name__}")
    number = float(value)
    if not math.isfinite(number):
        raise PhugoidError(f"a formula is made of finite numbers, found {number}")
    written = str(int(number)) if number.is_integer() and abs(number) < 1e15 else repr(number)
    return Formula(written, _SUM if written.startswith("-") else _ATOM)


def _joined(left: Any, right: Any, mark: str, binds: int, of_left: int, of_right: int) -> Formula:
    return Formula(f"{_formula(left)._within(of_left)}{mark}{_formula(right)._within(of_right)}", binds)


def _maximum(a: Any, b: Any) -> Formula:
    a, b = _formula(a), _formula(b)
    return _formula((a + b + abs(a - b)) / 2)


def _minimum(a: Any, b: Any) -> Formula:
    a, b = _formula(a), _formula(b)
    return _formula((a + b - abs(a - b)) / 2)


#: What numpy's own numbers ask for when they stand on the left of a formula.
_OPERATIONS: dict[str, Callable[..., Formula]] = {
    "add": lambda a, b: _formula(a) + b,
    "subtract": lambda a, b: _formula(a) - b,
    "multiply": lambda a, b: _formula(a) * b,
    "divide": lambda a, b: _formula(a) / b,
    "power": lambda a, b: _formula(a) ** b,
    "square": lambda a: _formula(a) ** 2,
    "negative": lambda a: -_formula(a),
    "maximum": _maximum,
    "minimum": _minimum,
}


class Symbols:
    """The symbols of a plant by name: ``s.x``, ``s.u`` (the input), ``s.t`` (the time, s)."""

    def __init__(self, names: Iterable[str]) -> None:
        self._names = sorted(names)

    def __getattr__(self, name: str) -> Formula:
        if name.startswith("__") or name not in self._names:
            raise AttributeError(f"the plant has no `{name}`: there are {', '.join(self._names)}")
        return Formula(name)

    def __getitem__(self, name: str) -> Formula:
        return self.__getattr__(name)


class Plant:
    """A plant of one's own, ``x' = f(x, u, t) + Phi(x, u, t) theta``, for :func:`reproduce`: it is simulated with the true
    parameters, and the laws of the thesis and the flagship estimate them from what is measured.

    A subclass says what the plant is and writes its equations in :meth:`rates`::

        class Spring(phugoid.Plant):
            states = ["x", "v"]                                  # one to four, all measured unless outputs() says otherwise
            parameters = {                                       # one or two, the unknown ones; rates are linear in them
                "k": {"truth": 16.0, "lower": 8.0, "upper": 32.0, "start": 12.0, "lambda": 10.0},
                "c": {"truth": 3.0, "lower": 1.5, "upper": 6.0, "start": 4.0, "lambda": 5.0},
            }
            constants = {"m": 2.0}
            start = {"x": 0.05}                                  # zero where it is not given
            input = {"type": "sine", "amplitude": 10.0, "frequency": "2 rad/s"}
            duration_s, sample_time_s, eta = 6.0, 0.001, 0.001

            def rates(self, s):
                return {"x": s.v, "v": (s.u - s.k * s.x - s.c * s.v * abs(s.v)) / s.m}

        print(phugoid.reproduce(Spring()))

    Times are seconds; states, input, parameters and constants are in units of the user's choice. ``input`` has the keys of a
    case file: type ``step`` (amplitude, at), ``sine`` (amplitude, frequency) or ``doublet`` (amplitude, at, width). ``truth``,
    ``lower``, ``upper`` (both of one sign) and ``start`` of a parameter are in its unit; ``lambda`` (1/s) and ``eta`` are the
    settings of the printed laws.
    """

    #: What it shows, in a few words; the name of the class where it is empty.
    title: str = ""
    #: Names of the states.
    states: Sequence[str] = ()
    #: The unknown parameters by name, with ``truth``, ``lower``, ``upper``, ``start`` and ``lambda``.
    parameters: Mapping[str, Mapping[str, float]] = {}
    #: Known numbers by name.
    constants: Mapping[str, float] = {}
    #: States at the beginning; zero for one that is not named.
    start: Mapping[str, float] = {}
    #: The known input ``u`` over the time.
    input: Mapping[str, Any] = {}
    #: Length of the record, s.
    duration_s: float = 10.0
    #: Time between samples, s.
    sample_time_s: float = 0.001
    #: ``eta`` of the printed laws.
    eta: float = 0.001
    #: Spectral density of white noise on every output, output unit squared times seconds; none without.
    noise_power: Optional[float] = None
    #: Without noise: the noise that the flagship is told, as a part of the root mean square of each state.
    assumed_noise: float = 1e-5
    #: Seed of the noise.
    seed: int = 0

    def rates(self, s: Symbols) -> Mapping[str, Any]:
        """The rate of each state by its name, in its unit per second. It is called with symbols (``s.x``, ``s.u``, ``s.t``) and
        has to give the same formulas whenever it is called."""
        raise NotImplementedError(f"{type(self).__name__} needs a method rates(self, s) that gives the rate of every state")

    def outputs(self, s: Symbols) -> Mapping[str, Any]:
        """What is measured, by name: at most one per state. Nothing given: every state is measured."""
        return {}

    def case(self) -> dict[str, Any]:
        """The case file of this plant, as a dictionary with its tables and keys.

        :raises PhugoidError: if the equations compare symbols, use functions that formulas do not have, or are not the same
            twice.
        """
        symbols = Symbols([*self.states, *self.parameters, *self.constants, "u", "t"])
        return {
            "title": self.title or type(self).__name__,
            "duration": f"{float(self.duration_s)!r} s",
            "sample_time": f"{float(self.sample_time_s)!r} s",
            "seed": int(self.seed),
            "plant": {
                "type": "own",
                "states": list(self.states),
                "parameters": list(self.parameters),
                "constants": {name: float(value) for name, value in self.constants.items()},
                "start": {name: float(value) for name, value in self.start.items()},
                "rates": self._traced("rates", self.rates, symbols),
                "outputs": self._traced("outputs", self.outputs, symbols),
            },
            "parameters": {name: dict(values) for name, values in self.parameters.items()},
            "input": dict(self.input),
            "estimator": {"eta": float(self.eta), "assumed_noise": float(self.assumed_noise)},
            **({} if self.noise_power is None else {"noise": {"power": float(self.noise_power)}}),
        }

    def _traced(self, what: str, equations: Callable[[Symbols], Mapping[str, Any]], symbols: Symbols) -> dict[str, str]:
        def once() -> dict[str, str]:
            found: Any = equations(symbols)
            if not isinstance(found, Mapping):
                raise PhugoidError(f"{type(self).__name__}.{what}() has to return a dictionary by name, found {type(found).__name__}")
            return {str(name): str(_formula(value)) for name, value in found.items()}

        first = once()
        if once() != first:
            raise PhugoidError(
                f"{type(self).__name__}.{what}() gives other formulas when it is called again: a plant has no memory and nothing "
                "random"
            )
        return first
