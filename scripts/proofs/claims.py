"""What is proved. Each claim is a function that raises a Violation where it does not hold, what it says, and a change of one line of
the sources with which it must not hold: `CLAIMS`."""

import z3

import machine
from integers import Integers, proved
from machine import Machine, Path, Undecided, Violation
from terms import Float, constant, difference, joined, lower, negated, of_bits, product, quotient, symbolic, total, upper, variables

# Objects lie here, far from each other.
AT = [0x3000_0000 + 0x10_0000 * i for i in range(8)]
LONG, PAIRS, ROOM, PLACES, DENSE, FRAMES = 24, 9, 11, 24, 6, 160
SMALL_SIZES = 4
# The paths multiply with each pivot that is looked at.
FACTORED = 3


def require(holds, what):
    if not holds:
        raise Violation(what)


class Call:
    """A call with objects of symbols in memory."""

    def __init__(self, image):
        self.machine, self.path = Machine(image), Path()

    def numbers(self, at, name, count, writable=False):
        """Floating-point numbers, each a symbol."""
        self.machine.objects.append((at, 8 * count, writable))
        made = [Float("in", f"{name}[{i}]") for i in range(count)]
        for i, number in enumerate(made):
            self.path.memory[at + 8 * i], self.path.memory[at + 8 * i + 4] = lower(number), upper(number)
        return made

    def words(self, at, count, writable=False):
        """Words of which nothing is known."""
        self.machine.objects.append((at, 4 * count, writable))

    def run(self, function, *arguments):
        return self.machine.run(function, list(arguments), self.path)

    def only(self, function, *arguments):
        paths = self.run(function, *arguments)
        require(len(paths) == 1, f"{function} takes {len(paths)} ways where one was expected")
        return paths[0]

    def number(self, path, at):
        return of_bits(self.machine.load(path, at, 64))

    def array(self, path, at, count):
        return [self.number(path, at + 8 * i) for i in range(count)]


def same(found, expected, what):
    for i, (f, e) in enumerate(zip(found, expected, strict=True)):
        require(f is e, f"{what}, number {i}: {f} in place of {e}")


# --- kernels -----------------------------------------------------------------------------------------------------------


def dot(x, y):
    """As `kernels::dot` says: the rest, and four partial sums."""
    blocks = len(x) // 4 * 4
    rest = constant(0.0)
    for a, b in zip(x[blocks:], y[blocks:]):
        rest = total(rest, product(a, b))
    if not blocks:
        return rest
    sums = [constant(0.0)] * 4
    for i in range(blocks):
        sums[i % 4] = total(sums[i % 4], product(x[i], y[i]))
    return total(total(total(sums[0], sums[2]), total(sums[1], sums[3])), rest)


# All pairs around the block of four, and all equal lengths.
LENGTHS = [(n, m) for n in range(LONG + 1) for m in range(LONG + 1) if n == m or max(n, m) <= PAIRS]


def kernel_add_scaled(image):
    for n, m in LENGTHS:
        call = Call(image)
        y = call.numbers(AT[0], "y", LONG, True)
        x = call.numbers(AT[1], "x", LONG)
        [a] = call.numbers(AT[2], "a", 1)
        path = call.only("kernel_add_scaled", AT[0], n, AT[1], m, AT[2])
        expected = [total(y[i], product(a, x[i])) if i < min(n, m) else y[i] for i in range(LONG)]
        same(call.array(path, AT[0], LONG), expected, f"lengths {n} and {m}")


def kernel_dot(image):
    for n, m in LENGTHS:
        call = Call(image)
        x, y = call.numbers(AT[0], "x", LONG), call.numbers(AT[1], "y", LONG)
        call.numbers(AT[2], "out", 1, True)
        path = call.only("kernel_dot", AT[0], n, AT[1], m, AT[2])
        shorter = min(n, m)
        same(call.array(path, AT[2], 1), [dot(x[:shorter], y[:shorter])], f"lengths {n} and {m}")


def kernel_rotate(image):
    for n, m in LENGTHS:
        call = Call(image)
        u, b = call.numbers(AT[0], "u", LONG, True), call.numbers(AT[1], "b", LONG, True)
        scale, g = call.numbers(AT[2], "by", 2)
        path = call.only("kernel_rotate", AT[0], n, AT[1], m, AT[2])
        used = range(min(n, m))
        same(
            call.array(path, AT[0], LONG),
            [total(u[i], product(scale, b[i])) if i in used else u[i] for i in range(LONG)],
            f"u of lengths {n} and {m}",
        )
        same(
            call.array(path, AT[1], LONG),
            [total(b[i], product(g, u[i])) if i in used else b[i] for i in range(LONG)],
            f"b of lengths {n} and {m}",
        )


# --- lists of places ---------------------------------------------------------------------------------------------------


def bounded_at(image):
    call = Call(image)
    values = call.numbers(AT[0], "values", PLACES)
    call.numbers(AT[1], "out", 1, True)
    length, place = z3.BitVecs("length place", 32)
    for path in call.run("bounded_at", AT[0], length, place, AT[1]):
        found = call.number(path, AT[1])
        if found is constant(0.0):
            outside = z3.Or(z3.UGE(place, length), z3.UGE(place, PLACES))
            require(path.holds(outside), "zero for a place that is there")
        else:
            require(found in values, f"{found} for a place")
            inside = z3.And(place == values.index(found), z3.ULT(place, length))
            require(path.holds(inside), f"{found} for another place")


def list_of_places(call):
    """A list of which nothing is known: where its count and its columns lie."""
    none = Call(call.machine.image)
    none.words(AT[0], PLACES + 1, True)
    path = none.only("places_none", AT[0])
    require(len(path.written & set(range(AT[0], AT[0] + 4 * PLACES + 4))) == PLACES + 1, "a list has another size")
    call.words(AT[0], PLACES + 1, True)
    # The count is what `len` reads.
    reading = Call(call.machine.image)
    reading.words(AT[0], PLACES + 1)
    [count] = {key for path in reading.run("places_len", AT[0]) for key in path.memory if AT[0] <= key < AT[0] + 0x1000}
    columns = [at for at in range(AT[0], AT[0] + 4 * PLACES + 4, 4) if at != count]
    words = {at: z3.BitVec(f"memory_{at:x}", 32) for at in [count, *columns]}
    call.path.memory.update(words)
    return count, columns, words


def places_push(image):
    call = Call(image)
    count, columns, before = list_of_places(call)
    column = z3.BitVec("column", 32)
    taken = set()
    for path in call.run("places_push", AT[0], column):
        changed = [at for at in before if path.memory[at] is not before[at]]
        fits = z3.And(z3.ULT(column, PLACES), z3.ULT(before[count], PLACES))
        if not changed:
            require(path.holds(z3.Not(fits)), "a column that fits is not taken")
            continue
        require(path.holds(fits), "a column is taken that does not fit")
        require(len(changed) == 2 and count in changed, "something else is written")
        [at] = set(changed) - {count}
        require(path.holds(before[count] == columns.index(at)), "a column is put in another place")
        require(path.holds(symbolic(path.memory[at], 32) == column), "another column is taken")
        require(path.holds(symbolic(path.memory[count], 32) == before[count] + 1), "the count is wrong")
        taken.add(at)
    require(taken == set(columns), "a place of the list is never used")


def places_column(image):
    call = Call(image)
    count, columns, before = list_of_places(call)
    place = z3.BitVec("place", 32)
    for path in call.run("places_column", AT[0], place):
        found = symbolic(call.machine.get(path, "r0", 32), 32)
        require(path.holds(z3.ULT(found, PLACES)), "a column beyond the room")
        for i, at in enumerate(columns):
            right = z3.Implies(z3.And(place == i, z3.ULT(before[at], PLACES)), found == before[at])
            require(path.holds(right), "another column than the one of the list")
    for path in call.run("places_len", AT[0]):
        found = symbolic(call.machine.get(path, "r0", 32), 32)
        require(path.holds(z3.ULE(found, PLACES)), "a list longer than its room")
        right = z3.Implies(z3.ULE(before[count], PLACES), found == before[count])
        require(path.holds(right), "another length than that of the list")


# --- the ring of frames ------------------------------------------------------------------------------------------------

RING_BYTES = 0x4000  # more than it has
FRAME_BYTES = 24


class Ring(Call):
    """A history of which nothing is known, and numbers of frames."""

    def __init__(self, image):
        super().__init__(image)
        self.words(AT[0], RING_BYTES // 4, True)
        self.words(AT[1], 8, True)
        self.words(AT[2], 4)
        self.words(AT[3], 4)
        path = self.only("ring_newest", AT[0], AT[1])
        self.newest_at = int(path.memory[AT[1]].decl().name().removeprefix("memory_"), 16)
        self.newest = z3.Concat(*(z3.BitVec(f"memory_{self.newest_at + o:x}", 32) for o in (4, 0)))
        self.number = z3.Concat(*(z3.BitVec(f"memory_{AT[2] + o:x}", 32) for o in (4, 0)))
        # Before 2^64 frames, six thousand million years at 100 Hz.
        self.path.conditions.append(self.newest != (1 << 64) - 1)
        cleared = self.only("ring_clear", AT[0])
        starts = [
            at
            for at in cleared.written
            if at + 4 in cleared.written
            and cleared.holds(symbolic(joined(cleared.memory[at], cleared.memory[at + 4]), 64) == self.newest + 1)
        ]
        require(len(starts) == 1, "clear does not begin after the newest frame")
        self.first_at = starts[0]
        self.first = z3.Concat(*(z3.BitVec(f"memory_{self.first_at + o:x}", 32) for o in (4, 0)))
        self.places = {}
        self.machine.place_of = self.place

    def place(self, path, address):
        """The frame that an address belongs to, and the word in it, after the proof that it is the frame at the place
        `number % 160` of the ring, whatever the number is."""
        # Another word of a frame that has been looked at already.
        for (which, offset), known in self.places.items():
            further = z3.simplify(address - known)
            if z3.is_bv_value(further) and 0 <= (further.as_long() + offset) % (1 << 32) < FRAME_BYTES:
                return which, (further.as_long() + offset) % (1 << 32)
        names = set(variables(address))
        # The number as 160 turns + 32 fifths + rest: every number is one such.
        turns, fifth, rest = z3.Ints("turns fifth rest")
        number = 160 * turns + 32 * fifth + rest
        facts = [turns >= 0, fifth >= 0, fifth < 5, rest >= 0, rest < 32, number < 1 << 64]
        if names <= {f"memory_{AT[2] + o:x}" for o in (0, 4)}:
            which, kept, at = "asked", number, AT[2]
        elif names <= {f"memory_{self.newest_at + o:x}" for o in (0, 4)}:
            which, kept, at = "newest", number - 1, self.newest_at
            facts.append(number >= 1)
        else:
            raise Violation(f"an address depends on {names}")
        low, high = z3.Ints("low high")
        facts += [kept == high * (1 << 32) + low, low >= 0, low < 1 << 32, high >= 0]
        integers = Integers({f"memory_{at:x}": low, f"memory_{at + 4:x}": high}, facts)
        value = integers.of(address)
        # Which word of a frame: from the address for one number.
        example = z3.substitute(address, *((z3.BitVec(f"memory_{at + o:x}", 32), z3.BitVecVal(0, 32)) for o in (0, 4)))
        example = z3.simplify(example).as_long() - AT[0] - (0 if which == "asked" else FRAME_BYTES)
        require(0 <= example < FRAME_BYTES and example % 4 == 0, "a frame lies at another place than the remainder of its number")
        right = value == AT[0] + FRAME_BYTES * (32 * fifth + rest) + example
        require(proved(integers.facts, right), "a frame does not lie at the remainder of its number")
        self.places[which, example] = address
        return which, example

    def within(self, number):
        """What the history says that it keeps."""
        return z3.And(
            z3.UGE(number, self.first), z3.ULE(number, self.newest), z3.ULT(self.newest - number, FRAMES)
        )


def ring_places(image):
    """Where frames lie. Two numbers of which one is kept while the other is the newest never share a place."""
    ring = Ring(image)
    require(ring.newest_at >= AT[0] + FRAMES * FRAME_BYTES, "the counters lie among the frames")
    path = ring.only("ring_push", AT[0], AT[3])
    frame = {("newest", o) for o in range(0, FRAME_BYTES, 4)}
    written = {key for key in path.written if not (isinstance(key, int) and key >= machine.STACK and key < AT[0])}
    require(written == frame | {ring.newest_at, ring.newest_at + 4}, f"push writes {written}")
    after = symbolic(joined(path.memory[ring.newest_at], path.memory[ring.newest_at + 4]), 64)
    require(path.holds(after == ring.newest + 1), "the newest frame has another number")
    sample = [z3.BitVec(f"memory_{AT[3] + o:x}", 32) for o in range(0, 16, 4)]
    stored = [symbolic(path.memory["newest", o], 32) for o in range(8, 24, 4)]
    require(path.memory["newest", 0] == 1, "the frame is not marked as there")
    require(all(path.holds(a == b) for a, b in zip(stored, sample)), "the frame is another one than the sample")
    a, b, turns_a, turns_b, place = z3.Ints("a b turns_a turns_b place")
    facts = [a == 160 * turns_a + place, b == 160 * turns_b + place, place >= 0, place < 160, a > b, a - b < FRAMES]
    require(proved(facts, z3.BoolVal(False)), "two frames that are kept share a place")


def ring_frames(image):
    """What is given for a number."""
    ring = Ring(image)
    given = 0
    for path in ring.run("ring_frame", AT[0], AT[2], AT[1]):
        kept = z3.And(ring.within(ring.number), present(path))
        if path.memory[AT[1]] == 0:
            require(path.holds(z3.Not(kept)), "a frame that is kept is not given")
            continue
        require(path.memory[AT[1]] == 1, "neither given nor not")
        require(path.holds(kept), "a frame is given that is not kept")
        for o in range(8, 24, 4):
            require(path.memory[AT[1] + o] is path.memory["asked", o], "another frame is given")
        given += 1
    require(given == 1, "a frame is given in several ways")
    # The newest, after a push: the number is the one that the ring has now.
    ring = Ring(image)
    pushed = ring.only("ring_push", AT[0], AT[3])
    pushed.conditions.append(z3.ULE(ring.first, ring.newest + 1))
    for o in (0, 4):
        pushed.memory[AT[2] + o] = pushed.memory[ring.newest_at + o]
    ring.path = pushed
    path = ring.only("ring_frame", AT[0], AT[2], AT[1])
    require(path.memory[AT[1]] == 1, "the newest frame is not given")
    for o in range(0, 16, 4):
        sample = z3.BitVec(f"memory_{AT[3] + o:x}", 32)
        require(path.holds(symbolic(path.memory[AT[1] + 8 + o], 32) == sample), "the newest frame is another one")


def present(path):
    """The mark of the frame that was looked at; where none was, nothing is said of it."""
    mark = path.memory.get(("asked", 0))
    return z3.BoolVal(True) if mark is None else symbolic(mark, 32) & 1 == 1


def ring_snapshots(image):
    ring = Ring(image)
    given = 0
    for path in ring.run("ring_before", AT[0], AT[2], AT[1]):
        if path.memory[AT[1]] == 0:
            continue
        given += 1
        snapshot = symbolic(joined(path.memory[AT[1] + 8], path.memory[AT[1] + 12]), 64)
        number = z3.BitVec("number", 64)
        since = z3.And(z3.UGE(number, snapshot), z3.ULE(number, ring.newest))
        require(path.holds(z3.Implies(since, ring.within(number))), "a snapshot without all frames since")
    require(given, "no snapshot is ever given")


def ring_clear(image):
    ring = Ring(image)
    ring.path = ring.only("ring_clear", AT[0])
    ring.path.conditions.append(z3.ULE(ring.number, ring.newest))
    for path in ring.run("ring_frame", AT[0], AT[2], AT[1]):
        require(path.memory[AT[1]] == 0, "a frame from before is given")
    for path in ring.run("ring_before", AT[0], AT[2], AT[1]):
        require(path.memory[AT[1]] == 0, "a snapshot from before is given")


# --- the factored covariance -------------------------------------------------------------------------------------------


class Covariance(Call):
    """A covariance of size `n` in its room, all factors symbols."""

    def __init__(self, image, n):
        super().__init__(image)
        size = 8 * (ROOM * ROOM + ROOM) + 8
        self.n = n
        self.places(image)
        self.machine.objects.append((AT[0], size, True))
        self.d = [Float("in", f"D[{i}]") for i in range(ROOM)]
        self.u = [[Float("in", f"U[{i}][{j}]") for i in range(ROOM)] for j in range(ROOM)]
        for j in range(ROOM):
            self.put(self.diagonal + 8 * j, self.d[j])
            for i in range(ROOM):
                self.put(self.columns + 8 * (ROOM * j + i), self.u[j][i])
        self.path.memory[self.length] = n

    def put(self, at, number):
        self.path.memory[at], self.path.memory[at + 4] = lower(number), upper(number)

    def places(self, image):
        """Where the fields lie: a covariance is made of known variances, and looked at."""
        made = Call(image)
        words = 2 * (ROOM * ROOM + ROOM) + 2
        made.words(AT[0], words, True)
        made.machine.objects.append((AT[1], 8 * ROOM, False))
        for i in range(ROOM):
            number = constant(1.0 + i)
            made.path.memory[AT[1] + 8 * i], made.path.memory[AT[1] + 8 * i + 4] = lower(number), upper(number)
        path = made.only("ud_from_variances", AT[0], AT[1], ROOM)
        ends = AT[0] + 4 * words
        variances = [
            at
            for at in range(AT[0], ends - 8 * ROOM, 8)
            if all(made.number(path, at + 8 * i) is constant(1.0 + i) for i in range(ROOM) if at + 8 * i in path.memory)
            and at in path.memory
        ]
        [self.length] = [at for at in range(AT[0], ends, 4) if at in path.memory and path.memory[at] == ROOM]
        [self.diagonal] = variances
        self.columns = AT[0] if self.diagonal > AT[0] else AT[0] + 8 * ROOM
        fields = [(self.columns, 8 * ROOM * ROOM), (self.diagonal, 8 * ROOM), (self.length, 4)]
        for i, (at, size) in enumerate(fields):
            require(
                all(at + size <= other or other + length <= at for other, length in fields[i + 1 :]),
                "the fields of a covariance lie elsewhere",
            )

    def check(self, path, d, u, what):
        """The factors are these, and nothing else of the covariance has changed."""
        same(self.array(path, self.diagonal, ROOM), d + self.d[self.n :], f"{what}, D")
        for j in range(ROOM):
            expected = [u[j][i] if i < j < self.n else self.u[j][i] for i in range(ROOM)]
            same(self.array(path, self.columns + 8 * ROOM * j, ROOM), expected, f"{what}, column {j} of U")
        require(path.memory[self.length] == self.n, f"{what}: another size")


def ud_measure(image):
    for n in range(ROOM + 1):
        call = Covariance(image, n)
        a, [r] = call.numbers(AT[1], "a", ROOM), call.numbers(AT[2], "r", 1)
        call.numbers(AT[3], "variance", 1, True)
        call.numbers(AT[4], "out", ROOM, True)
        path = call.only("ud_measure", AT[0], AT[1], AT[2], AT[3], AT[4])
        # Bierman's recursion, as his book writes it.
        f = [total(a[j], dot(call.u[j][:j], a[:j])) for j in range(n)]
        g = [product(call.d[j], f[j]) for j in range(n)]
        variance = r
        for j in range(n):
            variance = total(variance, product(f[j], g[j]))
        d, u, b = [], [list(column) for column in call.u], []
        alpha, inverse = r, quotient(constant(1.0), r)
        for j in range(n):
            before, inverse_before = alpha, inverse
            alpha = total(alpha, product(f[j], g[j]))
            inverse = quotient(constant(1.0), alpha)
            d.append(product(call.d[j], product(before, inverse)))
            scale = product(negated(f[j]), inverse_before)
            for i in range(j):
                old = u[j][i]
                u[j][i] = total(old, product(scale, b[i]))
                b[i] = total(b[i], product(g[j], old))
            b.append(g[j])
        call.check(path, d, u, f"size {n}")
        same(call.array(path, AT[3], 1), [variance], f"size {n}, variance")
        same(call.array(path, AT[4], ROOM), b + [constant(0.0)] * (ROOM - n), f"size {n}, b")
        signs = Signs(at_least_zero=call.d, above_zero=[r])
        for j in range(n):
            require(signs.at_least_zero(d[j]), f"size {n}: D[{j}] may become negative: {d[j]}")
        # What has to be assumed for that: with an r of any sign there must be no such proof.
        careless = Signs(at_least_zero=call.d, above_zero=[])
        require(not n or not careless.at_least_zero(d[-1]), "the signs are proved of whatever there is")
        require(signs.above_zero(variance), f"size {n}: the variance of the innovation may not be positive")


class Signs:
    """The signs of results, from the signs of what they are made of. "At least zero" and "above zero" are said of every
    number but NaN, which is never called negative. The rules are theorems about double precision that z3 proves."""

    rules = None

    def __init__(self, at_least_zero, above_zero):
        self.not_negative, self.positive = set(at_least_zero), set(above_zero)
        self.known = {}
        if Signs.rules is None:
            Signs.rules = prove_rules()

    def above_zero(self, t):
        if t in self.positive:
            return True
        if t.op == "const":
            return 0 < t.args[0] <= 0x7FF << 52
        if t.op == "add":
            a, b = t.args
            return self.above_zero(a) and self.at_least_zero(b) or self.above_zero(b) and self.at_least_zero(a)
        return False

    def at_least_zero(self, t):
        if t not in self.known:
            self.known[t] = self.found(t)
        return self.known[t]

    def found(self, t):
        if t in self.not_negative or self.above_zero(t):
            return True
        if t.op == "const":
            return t.args[0] in (0, 1 << 63)
        if t.op == "add":
            return all(self.at_least_zero(a) for a in t.args)
        if t.op == "div":
            return self.at_least_zero(t.args[0]) and self.above_zero(t.args[1])
        if t.op == "mul":
            if all(self.at_least_zero(a) for a in t.args):
                return True
            # f (d f), where d is not negative.
            for one, other in (t.args, t.args[::-1]):
                if other.op == "mul" and one in other.args:
                    rest = other.args[1] if other.args[0] is one else other.args[0]
                    return self.at_least_zero(rest)
        return False


def prove_rules():
    sort, mode = z3.Float64(), z3.RNE()
    x, y = z3.FP("x", sort), z3.FP("y", sort)
    zero = z3.FPVal(0.0, sort)

    def not_negative(a):
        return z3.Not(z3.fpLT(a, zero))

    def positive(a):
        return z3.Or(z3.fpGT(a, zero), z3.fpIsNaN(a))

    rules = {
        "a product": ([not_negative(x), not_negative(y)], not_negative(z3.fpMul(mode, x, y))),
        "a sum": ([not_negative(x), not_negative(y)], not_negative(z3.fpAdd(mode, x, y))),
        "a positive sum": ([positive(x), not_negative(y)], positive(z3.fpAdd(mode, x, y))),
        "a quotient": ([not_negative(x), positive(y)], not_negative(z3.fpDiv(mode, x, y))),
        "a square": ([not_negative(x)], not_negative(z3.fpMul(mode, y, z3.fpMul(mode, x, y)))),
    }
    # One that does not hold, which has to be found.
    rules["a difference"] = ([not_negative(x), not_negative(y)], not_negative(z3.fpSub(mode, x, y)))
    for name, (facts, claim) in rules.items():
        solver = z3.SolverFor("QF_FP")
        solver.set("timeout", 60_000)
        solver.add(*facts, z3.Not(claim))
        answer = solver.check()
        if answer == z3.unknown:
            raise Undecided(f"z3 does not decide the sign of {name}")
        expected = z3.sat if name == "a difference" else z3.unsat
        require(answer == expected, f"the sign of {name} is not as expected")
    return rules


def ud_predict(image):
    for n in range(SMALL_SIZES + 1):
        call = Covariance(image, n)
        flat, q = call.numbers(AT[1], "A", ROOM * ROOM), call.numbers(AT[2], "q", ROOM)
        a = [flat[ROOM * i : ROOM * i + ROOM] for i in range(ROOM)]
        signs = Signs(at_least_zero=call.d + q, above_zero=[])
        paths = call.run("ud_predict", AT[0], AT[1], AT[2])
        for path in paths:
            # Thornton's recursion: weighted Gram-Schmidt on the rows of [A U, I] with the weights [D, q].
            left = [[total(a[i][j], dot(call.u[j][:j], a[i][:j])) for j in range(n)] for i in range(n)]
            right = [[constant(1.0 if i == j else 0.0) for j in range(n)] for i in range(n)]
            d, u = list(call.d[:n]), [list(column) for column in call.u]
            for j in reversed(range(n)):
                weighted_left = [product(left[j][k], call.d[k]) for k in range(n)]
                weighted_right = [product(right[j][k], q[k]) for k in range(n)]
                variance = constant(0.0)
                for k in range(n):
                    part = total(product(left[j][k], weighted_left[k]), product(right[j][k], weighted_right[k]))
                    variance = total(variance, part)
                d[j] = variance
                require(signs.at_least_zero(variance), f"size {n}: D[{j}] may become negative: {variance}")
                above = machine.compared("lt", constant(0.0), variance)
                if path.holds(above):
                    inverse = quotient(constant(1.0), variance)
                else:
                    require(path.holds(z3.Not(above)) or j == 0, f"size {n}: a variance is not looked at")
                    inverse = constant(0.0)
                for i in range(j):
                    sum_ = constant(0.0)
                    for k in range(n):
                        part = total(product(left[i][k], weighted_left[k]), product(right[i][k], weighted_right[k]))
                        sum_ = total(sum_, part)
                    u[j][i] = product(sum_, inverse)
                    for k in range(n):
                        left[i][k] = difference(left[i][k], product(u[j][i], left[j][k]))
                        right[i][k] = difference(right[i][k], product(u[j][i], right[j][k]))
            call.check(path, d, u, f"size {n}")


def ud_add_rank_one(image):
    for n in range(SMALL_SIZES + 1):
        call = Covariance(image, n)
        [c0], a0 = call.numbers(AT[1], "c", 1), call.numbers(AT[2], "a", ROOM)
        paths = call.run("ud_add_rank_one", AT[0], AT[1], AT[2])
        for path in paths:
            d, u, a, c = list(call.d[:n]), [list(column) for column in call.u], list(a0), c0
            usable = z3.And(machine.compared("lt", constant(0.0), c0), finite(c0))
            if path.holds(z3.Not(usable)):
                call.check(path, d, u, f"size {n}, no increase")
                continue
            require(path.holds(usable), f"size {n}: the increase is not looked at")
            signs = Signs(at_least_zero=call.d, above_zero=[c0])
            for j in reversed(range(n)):
                after = total(d[j], product(product(c, a[j]), a[j]))
                zero = machine.compared("le", after, constant(0.0))
                if path.holds(zero):
                    continue
                # Looked at and above zero (or NaN): the quotients below are by it.
                require(path.holds(z3.Not(zero)), f"size {n}: a variance is not looked at")
                signs.positive.add(after)
                beta = quotient(product(c, a[j]), after)
                c = product(c, quotient(d[j], after))
                require(signs.at_least_zero(c), f"size {n}: the rest of the increase may be negative")
                d[j] = after
                for i in range(j):
                    a[i] = difference(a[i], product(a[j], u[j][i]))
                    u[j][i] = total(u[j][i], product(beta, a[i]))
            for j in range(n):
                require(signs.at_least_zero(d[j]), f"size {n}: D[{j}] may become negative")
            call.check(path, d, u, f"size {n}")


def finite(number):
    return z3.Extract(62, 52, symbolic(number, 64)) != 0x7FF


# --- Cholesky ----------------------------------------------------------------------------------------------------------


def cholesky(image):
    for n in range(FACTORED + 1):
        call = Call(image)
        flat, b0 = call.numbers(AT[0], "A", DENSE * DENSE, True), call.numbers(AT[1], "b", DENSE, True)
        ends = 0
        for path in call.run("cholesky_solve", AT[0], n, AT[1]):
            a, b = [flat[DENSE * i : DENSE * i + DENSE] for i in range(DENSE)], list(b0)
            inverse, refused = [], False
            for i in range(n):
                for j in range(i):
                    a[i][j] = product(difference(a[i][j], dot(a[i][:j], a[j][:j])), inverse[j])
                pivot = difference(a[i][i], dot(a[i][:i], a[i][:i]))
                above = machine.compared("lt", constant(0.0), pivot)
                if not (path.holds(above) and path.holds(finite(pivot))):
                    refused = True
                    break
                a[i][i] = Float("sqrt", pivot)
                inverse.append(quotient(constant(1.0), a[i][i]))
            require(call.machine.get(path, "r0", 32) == (0 if refused else 1), f"size {n}: refused where it must not be")
            if not refused:
                ends += 1
                for i in range(n):
                    b[i] = product(difference(b[i], dot(a[i][:i], b[:i])), inverse[i])
                for i in reversed(range(n)):
                    b[i] = product(b[i], inverse[i])
                    for k in range(i):
                        b[k] = total(b[k], product(negated(b[i]), a[i][k]))
            same(call.array(path, AT[1], DENSE), b, f"size {n}, solution")
            same(call.array(path, AT[0], DENSE * DENSE), [x for row in a for x in row], f"size {n}, factor")
        require(ends >= 1, f"size {n}: nothing is ever factored")


CLAIMS = {
    "kernel_add_scaled": (
        kernel_add_scaled,
        f"`kernels::add_scaled` is y + a x over the shorter length and leaves the rest as it was (all pairs of lengths 0..={PAIRS}, equal lengths up to {LONG})",
        ("kernels.rs", "        *y += a * x;", "        *y -= a * x;"),
    ),
    "kernel_dot": (
        kernel_dot,
        f"`kernels::dot` is the sum of all products over the shorter length, in its four partial sums (all pairs of lengths 0..={PAIRS}, equal lengths up to {LONG})",
        ("kernels.rs", "for (x, y) in x_rest.iter().zip(y_rest)", "for (x, y) in x_rest.iter().skip(1).zip(y_rest)"),
    ),
    "kernel_rotate": (
        kernel_rotate,
        f"`kernels::rotate` takes u and b of before for both results, over the shorter length (all pairs of lengths 0..={PAIRS}, equal lengths up to {LONG})",
        ("kernels.rs", "            b[l] += g * before;", "            b[l] += g * u[l];"),
    ),
    "bounded_at": (
        bounded_at,
        f"`bounded::at` is the number at a place, and zero exactly from the length on (any place, any length up to {PLACES})",
        ("bounded.rs", "values.get(place).copied()", "values.get(place + 1).copied()"),
    ),
    "places_push": (
        places_push,
        f"`Places::push` appends a column below the room, once, behind the others, and else changes nothing (any list in room {PLACES}, any column)",
        ("bounded.rs", ".filter(|_| column < P)", ".filter(|_| column <= P)"),
    ),
    "places_column": (
        places_column,
        f"`Places::column` and `len` are those of the list and never beyond its room (any memory, any place, room {PLACES})",
        ("bounded.rs", "(*column).min(P.saturating_sub(1))", "(*column).min(P)"),
    ),
    "ring_places": (
        ring_places,
        f"`History::push` writes one frame, at the remainder of its number by {FRAMES}, and its number; no two frames that are kept share a place (any history, any number below 2^64)",
        ("supervisor/history.rs", "(number % F as u64) as usize", "(number % F as u64 / 2) as usize"),
    ),
    "ring_frames": (
        ring_frames,
        f"`History::frame` gives the frame of that number exactly while it is among the last {FRAMES} and not forgotten; the newest is the one that was pushed (any history, any number)",
        ("supervisor/history.rs", "self.newest - number < F as u64;", "self.newest - number <= F as u64;"),
    ),
    "ring_snapshots": (
        ring_snapshots,
        "`History::before` gives no snapshot of which a frame since is gone (any history, any number)",
        ("supervisor/history.rs", "self.newest - snapshot.frame < F as u64 - 1", "self.newest - snapshot.frame < F as u64 + 1"),
    ),
    "ring_clear": (
        ring_clear,
        "`History::clear` leaves no frame and no snapshot of before (any history, any number)",
        ("supervisor/history.rs", "self.first = self.newest + 1;", "self.first = self.newest;"),
    ),
    "ud_measure": (
        ud_measure,
        f"`Ud::project` and `update` are Bierman's recursion, write D and the strict upper part of U up to the size and nothing else, and no D becomes negative (sizes 0..={ROOM} in room {ROOM}, any numbers with D >= 0 and r > 0)",
        ("ud.rs", "            alpha += f[j] * g[j];", "            alpha -= f[j] * g[j];"),
    ),
    "ud_predict": (
        ud_predict,
        f"`Ud::predict` is Thornton's recursion, writes nothing else, and no D becomes negative (sizes 0..={SMALL_SIZES} in room {ROOM}, any numbers with D >= 0 and q >= 0)",
        ("ud.rs", "                self.columns[j][i] = u;", "                self.columns[i][j] = u;"),
    ),
    "ud_add_rank_one": (
        ud_add_rank_one,
        f"`Ud::add_rank_one` is Agee and Turner's recursion, writes nothing else, and no D becomes negative (sizes 0..={SMALL_SIZES} in room {ROOM}, any numbers with D >= 0)",
        ("ud.rs", "            c *= before / after;", "            c *= after / before;"),
    ),
    "cholesky": (
        cholesky,
        f"`Cholesky::new` and `solve` are the factorisation row by row, in the lower triangle alone, and refuse every pivot that is not positive and finite (sizes 0..={FACTORED} in room {DENSE}, any numbers)",
        ("dense.rs", "add_scaled(&mut b[..i], -x, &self.lower[i][..i]);", "add_scaled(&mut b[..i], x, &self.lower[i][..i]);"),
    ),
}
