"""Index arithmetic of words as arithmetic of whole numbers, in which z3 decides a remainder by multiplication at once (with bits it
does not end: the compiler divides by multiplying). Every operation is translated exactly, its wrap at 2^32 included."""

import z3

from machine import Undecided, Violation


def is_bit(test):
    """Whether a condition is that one bit is set."""
    return (
        test.decl().kind() == z3.Z3_OP_EQ
        and z3.is_bv(test.arg(0))
        and test.arg(0).size() == 1
        and z3.is_bv_value(test.arg(1))
        and test.arg(1).as_long() == 1
    )


class Integers:
    def __init__(self, meanings, facts):
        """`meanings`: what each symbol of a word is as a whole number; `facts`: what is known of these."""
        self.meanings = meanings
        self.facts = list(facts)
        self.known, self.quotients = {}, {}

    def divided(self, value, by):
        """Quotient and remainder; the same ones where the same is asked again, which z3 would have to find out."""
        key = value.get_id(), by
        if key not in self.quotients:
            quotient, remainder = z3.Int(f"quotient{len(self.facts)}"), z3.Int(f"remainder{len(self.facts)}")
            self.facts += [value == by * quotient + remainder, remainder >= 0, remainder < by]
            self.quotients[key] = quotient, remainder, value
        return self.quotients[key][:2]

    def wrapped(self, value, low, high, size):
        """A result that may lie outside of a word, and its limits. Where it does not, as is proved first, it is itself."""
        if 0 <= low and high < 1 << size:
            return value, low, high
        for bound in (1 << k for k in (3, 8, 16, size)):
            if proved(self.facts, z3.And(value >= 0, value < bound), 1):
                return value, 0, bound - 1
        return self.divided(value, 1 << size)[1], 0, (1 << size) - 1

    def possible_bits(self, e):
        """The bits that may be set."""
        kind, everything = e.decl().kind(), (1 << e.size()) - 1
        if z3.is_bv_value(e):
            return e.as_long()
        parts = [self.possible_bits(c) for c in e.children()] if all(z3.is_bv(c) for c in e.children()) else []
        if kind == z3.Z3_OP_BAND:
            return parts[0] & parts[1]
        if kind == z3.Z3_OP_BOR:
            return parts[0] | parts[1]
        if kind == z3.Z3_OP_BSHL and z3.is_bv_value(e.arg(1)):
            return parts[0] << e.arg(1).as_long() & everything
        if kind == z3.Z3_OP_BLSHR and z3.is_bv_value(e.arg(1)):
            return parts[0] >> e.arg(1).as_long()
        return everything

    def of(self, e):
        """A word as a whole number."""
        return self.limited(e)[0]

    def limited(self, e):
        """The number, and limits of it."""
        key = e.get_id()
        if key not in self.known:
            value, low, high = self.translated(e)
            # A name of its own, so that long sums are written once.
            name = z3.Int(f"word{len(self.known)}")
            self.facts += [name == value, name >= low, name <= high]
            # The word is kept with it: its number would be used again for another one.
            self.known[key] = (name, low, high), e
        return self.known[key][0]

    def translated(self, e):
        if z3.is_bv_value(e):
            return z3.IntVal(e.as_long()), e.as_long(), e.as_long()
        kind, size = e.decl().kind(), e.size()
        everything = (1 << size) - 1
        if kind == z3.Z3_OP_UNINTERPRETED:
            if e.decl().name() not in self.meanings:
                raise Violation(f"an index depends on {e}")
            return self.meanings[e.decl().name()], 0, everything
        if kind == z3.Z3_OP_ITE:
            # A bit as a word.
            test, one, zero = e.children()
            if is_bit(test) and z3.is_bv_value(one) and z3.is_bv_value(zero) and (one.as_long(), zero.as_long()) == (1, 0):
                return self.of(test.arg(0)), 0, 1
            return z3.If(self.condition(test), self.of(one), self.of(zero)), 0, everything
        if kind == z3.Z3_OP_CONCAT:
            value = z3.IntVal(0)
            for part in e.children():
                value = value * (1 << part.size()) + self.of(part)
            return value, 0, everything
        if kind == z3.Z3_OP_EXTRACT:
            high_bit, low_bit = e.params()
            value, low, high = self.limited(e.arg(0))
            if low_bit:
                value, low, high = self.divided(value, 1 << low_bit)[0], low >> low_bit, high >> low_bit
            return self.cut(value, low, high, high_bit - low_bit + 1)
        if kind == z3.Z3_OP_ZERO_EXT:
            return self.limited(e.arg(0))
        if kind == z3.Z3_OP_BADD:
            parts = [self.limited(c) for c in e.children()]
            return self.wrapped(z3.Sum([p[0] for p in parts]), sum(p[1] for p in parts), sum(p[2] for p in parts), size)
        if kind == z3.Z3_OP_BSUB:
            a, b = (self.limited(c) for c in e.children())
            return self.wrapped(a[0] - b[0], a[1] - b[2], a[2] - b[1], size)
        if kind == z3.Z3_OP_BMUL and any(z3.is_bv_value(c) for c in e.children()):
            a, b = (self.limited(c) for c in e.children())
            return self.wrapped(a[0] * b[0] if a[1] != a[2] else a[1] * b[0], a[1] * b[1], a[2] * b[2], size)
        if kind == z3.Z3_OP_BSHL and z3.is_bv_value(e.arg(1)):
            by = e.arg(1).as_long()
            value, low, high = self.cut(*self.limited(e.arg(0)), size - by)
            return value * (1 << by), low << by, high << by
        if kind == z3.Z3_OP_BLSHR and z3.is_bv_value(e.arg(1)):
            by = e.arg(1).as_long()
            value, low, high = self.limited(e.arg(0))
            return self.divided(value, 1 << by)[0], low >> by, high >> by
        if kind == z3.Z3_OP_BOR and not self.possible_bits(e.arg(0)) & self.possible_bits(e.arg(1)):
            a, b = (self.limited(c) for c in e.children())
            return a[0] + b[0], a[1] + b[1], a[2] + b[2]
        if kind == z3.Z3_OP_BAND and z3.is_bv_value(e.arg(1)):
            mask = e.arg(1).as_long()
            first = (mask & -mask).bit_length() - 1
            width = mask.bit_length() - first
            if mask == (1 << width) - 1 << first:
                value, low, high = self.limited(e.arg(0))
                if first:
                    value, low, high = self.divided(value, 1 << first)[0], low >> first, high >> first
                value, low, high = self.cut(value, low, high, width)
                return value * (1 << first), low << first, high << first
        raise Violation(f"index arithmetic that is not known here: {e}")

    def cut(self, value, low, high, size):
        """The lowest bits of a number that is not negative."""
        if high < 1 << size:
            return value, low, high
        return self.divided(value, 1 << size)[1], 0, (1 << size) - 1

    def condition(self, c):
        kind = c.decl().kind()
        if kind == z3.Z3_OP_NOT:
            return z3.Not(self.condition(c.arg(0)))
        if kind in (z3.Z3_OP_ULT, z3.Z3_OP_ULEQ, z3.Z3_OP_UGT, z3.Z3_OP_UGEQ, z3.Z3_OP_EQ) and z3.is_bv(c.arg(0)):
            a, b = self.of(c.arg(0)), self.of(c.arg(1))
            return {
                z3.Z3_OP_ULT: a < b,
                z3.Z3_OP_ULEQ: a <= b,
                z3.Z3_OP_UGT: a > b,
                z3.Z3_OP_UGEQ: a >= b,
                z3.Z3_OP_EQ: a == b,
            }[kind]
        raise Violation(f"a condition of an index that is not known here: {c}")


def proved(facts, claim, tries=20):
    """Whether a claim about whole numbers follows from facts. z3 finds most such proofs within a second and some not for
    minutes, by chance: it begins anew with other random numbers."""
    for seed in range(tries):
        solver = z3.SolverFor("QF_LIA")
        solver.set("timeout", 1000 + 500 * seed)
        solver.set("random_seed", seed)
        solver.add(*facts, z3.Not(claim))
        answer = solver.check()
        if answer != z3.unknown:
            return answer == z3.unsat
    if tries == 1:
        return False
    raise Undecided(f"z3 does not decide a claim about an index in {tries} tries")
