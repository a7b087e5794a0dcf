"""Values of a symbolic execution: numbers that are known, words of which any bit pattern is possible (z3), and floating-point
numbers as the terms that made them.

A flight computer with a Cortex-M4F computes in double precision by calls (`__aeabi_dmul` and others), so that arithmetic shows as
calls and the terms can be kept as they are. Two results are the same for all inputs where their terms are the same. What is taken
to be equal of itself follows from IEEE 754 for every value but the sign and the payload of a NaN, which it leaves open: a sum and
a product do not depend on the order of two operands, a difference is the sum with the negative, and the sign of a factor is the
sign of the product.
"""

import struct

import z3

WORD = 0xFFFFFFFF


class Float:
    """A floating-point number: how it was made. The same term is the same object."""

    made = {}

    def __new__(cls, op, *args):
        key = (op, *(id(a) if isinstance(a, Float) else a for a in args))
        found = cls.made.get(key)
        if found is None:
            found = super().__new__(cls)
            found.op, found.args, found.number = op, args, len(cls.made)
            cls.made[key] = found
        return found

    def __repr__(self):
        return self.text(4)

    def text(self, depth):
        if self.op == "in":
            return self.args[0]
        if self.op == "const":
            return repr(struct.unpack("<d", struct.pack("<Q", self.args[0]))[0])
        return f"{self.op}({', '.join(a.text(depth - 1) if depth else '...' for a in self.args)})"


def constant(value):
    return Float("const", struct.unpack("<Q", struct.pack("<d", value))[0])


def of_bits(value):
    """The floating-point number of what 64 bits hold."""
    if isinstance(value, Float):
        return value
    if isinstance(value, int):
        return Float("const", value)
    # Put together of words or bytes: the number whose bits these are, or its negative.
    for number in floats_in(value):
        for candidate in (number, negated(number)):
            solver = z3.SolverFor("QF_BV")
            solver.add(value != bits(candidate))
            if solver.check() == z3.unsat:
                return candidate
    raise NotImplementedError(f"arithmetic with bits that are no number: {value}")


def variables(e):
    """The names of the symbols in a term of z3."""
    kept = VARIABLES.get(e.get_id())
    if kept is None:
        if z3.is_const(e) and e.decl().kind() == z3.Z3_OP_UNINTERPRETED:
            found = frozenset([e.decl().name()])
        else:
            found = frozenset().union(*(variables(c) for c in e.children()))
        # The term is kept with them: its number would be used again for another one.
        kept = VARIABLES[e.get_id()] = found, e
    return kept[0]


VARIABLES = {}


def floats_in(e):
    numbers = {int(name.removeprefix("float")) for name in variables(e) if name.startswith("float")}
    return [number for number in Float.made.values() if number.number in numbers]


def negated(a):
    if a.op == "neg":
        return a.args[0]
    if a.op == "const":
        return Float("const", a.args[0] ^ 1 << 63)
    return Float("neg", a)


def product(a, b):
    odd = (a.op == "neg") != (b.op == "neg")
    a, b = (x.args[0] if x.op == "neg" else x for x in (a, b))
    made = Float("mul", *sorted((a, b), key=lambda x: x.number))
    return negated(made) if odd else made


def quotient(a, b):
    odd = (a.op == "neg") != (b.op == "neg")
    a, b = (x.args[0] if x.op == "neg" else x for x in (a, b))
    made = Float("div", a, b)
    return negated(made) if odd else made


def total(a, b):
    # Nothing is added: minus zero is what leaves every number as it is.
    for one, other in ((a, b), (b, a)):
        if one.op == "const" and one.args[0] == 1 << 63:
            return other
        # Plus zero leaves all but minus zero.
        if one.op == "const" and one.args[0] == 0 and never_minus_zero(other):
            return other
    return Float("add", *sorted((a, b), key=lambda x: x.number))


def never_minus_zero(a):
    """A sum is minus zero only if both parts are."""
    if a.op == "const":
        return a.args[0] != 1 << 63
    return a.op == "mul" and a.args[0] is a.args[1] or a.op == "add" and any(never_minus_zero(x) for x in a.args)


def difference(a, b):
    return total(a, negated(b))


class Half:
    """The lower or upper word of a floating-point number."""

    def __init__(self, of, upper):
        self.of, self.upper = of, upper


def bits(number):
    """Any bits, but the same ones for the same number."""
    if number.op == "const":
        return z3.BitVecVal(number.args[0], 64)
    if number.op == "neg":
        return bits(number.args[0]) ^ (1 << 63)
    return z3.BitVec(f"float{number.number}", 64)


def symbolic(value, width):
    """As a term of z3."""
    if isinstance(value, int):
        return z3.BitVecVal(value, width)
    if isinstance(value, Float):
        return bits(value)
    if isinstance(value, Half):
        return z3.Extract(63, 32, bits(value.of)) if value.upper else z3.Extract(31, 0, bits(value.of))
    return value


def joined(low, high):
    """64 bits of two words."""
    if isinstance(low, int) and isinstance(high, int):
        return low | high << 32
    if isinstance(low, Half) and isinstance(high, Half) and low.of is high.of and not low.upper and high.upper:
        return low.of
    if isinstance(low, int) and isinstance(high, Half) and high.of.op == "const":
        return low | symbolic_word(high) << 32
    return z3.Concat(symbolic(high, 32), symbolic(low, 32))


def symbolic_word(half):
    return half.of.args[0] >> 32 if half.upper else half.of.args[0] & WORD


def lower(value):
    if isinstance(value, int):
        return value & WORD
    if isinstance(value, Float):
        return value.args[0] & WORD if value.op == "const" else Half(value, False)
    return value.arg(1) if is_pair(value) else z3.Extract(31, 0, value)


def upper(value):
    if isinstance(value, int):
        return value >> 32
    if isinstance(value, Float):
        return value.args[0] >> 32 if value.op == "const" else Half(value, True)
    return value.arg(0) if is_pair(value) else z3.Extract(63, 32, value)


def is_pair(value):
    return value.decl().kind() == z3.Z3_OP_CONCAT and value.num_args() == 2 and value.arg(0).size() == 32
