"""Executes functions of an ELF image for a Cortex-M with symbols in place of numbers, instruction by instruction as VEX (pyvex)
describes them, on every path that some input takes.

Nothing is passed over: an access outside the objects that the caller has named, an instruction or an operation that is not known
here, a loop without end and a call of the panic handler are errors.
"""

import struct

import archinfo
import pyvex
import z3

import terms
from terms import Float, Half, WORD, joined, lower, of_bits, symbolic, upper, variables

STACK, STACK_SIZE = 0x2000_0000, 0x8000
RETURN = 0x00F0_0000
ARCH = archinfo.ArchARMCortexM()
NAMES = {offset: name for name, (offset, _) in ARCH.registers.items()}
REGISTER = {name: offset for name, (offset, _) in ARCH.registers.items()}
LONGEST = 60_000  # blocks of one path


class Violation(Exception):
    """What was to be proved does not hold."""


class Undecided(Exception):
    """z3 has not found out in time whether it holds."""


class Fork(Exception):
    """The path divides: one branch for each condition. Together they are all that is possible."""

    def __init__(self, conditions):
        super().__init__()
        self.conditions = conditions


class Image:
    """Code and constants of an ELF file, and the addresses of its functions."""

    def __init__(self, path):
        self.data = path.read_bytes()
        if self.data[:6] != b"\x7fELF\x01\x01":
            raise SystemExit(f"{path} is not a 32-bit little-endian ELF file")
        programs, sections = struct.unpack_from("<2I", self.data, 28)
        _, program_count, _, section_count, _ = struct.unpack_from("<5H", self.data, 42)
        programs = [struct.unpack_from("<8I", self.data, programs + 32 * i) for i in range(program_count)]
        self.segments = [(va, self.data[at : at + size]) for kind, at, va, _, size, *_ in programs if kind == 1]
        sections = [struct.unpack_from("<10I", self.data, sections + 40 * i) for i in range(section_count)]
        [table] = [s for s in sections if s[1] == 2]
        names = sections[table[6]][4]
        self.functions = {}
        for at in range(table[4], table[4] + table[5], 16):
            name, address, _, info, _, _ = struct.unpack_from("<IIIBBH", self.data, at)
            if info & 15 == 2:
                name = self.data[names + name : self.data.index(b"\0", names + name)].decode()
                self.functions[name] = address & ~1
        self.blocks = {}

    def read(self, address, length):
        for start, data in self.segments:
            if start <= address and address + length <= start + len(data):
                return data[address - start : address - start + length]
        return None

    def block(self, address):
        """The instructions from an address up to the next branch."""
        found = self.blocks.get(address)
        if found is None:
            code = next(d[address - s : address - s + 400] for s, d in self.segments if s <= address < s + len(d))
            found = pyvex.IRSB(code, address | 1, ARCH, bytes_offset=1, opt_level=1, max_bytes=400)
            if found.jumpkind == "Ijk_NoDecode" and not found.statements:
                raise NotImplementedError(f"no instruction is known at {address:#x}")
            self.blocks[address] = found
        return found


class Path:
    """One path: registers, memory, and what has to hold of the input for it to be taken."""

    def __init__(self):
        self.registers, self.memory, self.conditions, self.decided = {}, {}, [], {}
        self.written = set()

    def copy(self):
        other = Path()
        other.registers, other.memory = dict(self.registers), dict(self.memory)
        other.conditions, other.decided = list(self.conditions), dict(self.decided)
        other.written = set(self.written)
        return other

    def possible(self, *more):
        solver = z3.SolverFor("QF_BV")
        solver.set("timeout", 60_000)
        solver.add(*self.relevant(more), *more)
        answer = solver.check()
        if answer == z3.unknown:
            raise Undecided(f"z3 does not decide a condition: {solver.reason_unknown()}")
        return answer == z3.sat

    def relevant(self, asked):
        """The conditions that have to do with what is asked. The path is possible, so that the others can be fulfilled too."""
        waiting, chosen = list(self.conditions), []
        symbols = set().union(*(variables(a) for a in asked))
        grown = True
        while grown and waiting:
            grown = False
            for condition in list(waiting):
                if not symbols.isdisjoint(variables(condition)):
                    symbols |= variables(condition)
                    chosen.append(condition)
                    waiting.remove(condition)
                    grown = True
        return chosen

    def holds(self, claim):
        """Whether a claim follows from the path's conditions."""
        return not self.possible(z3.Not(claim))

    def decide(self, condition):
        """Whether a condition holds on this path; divides the path where both can be."""
        if isinstance(condition, (bool, int)):
            return bool(condition)
        key = condition.get_id()
        if key not in self.decided:
            yes = self.possible(condition)
            if yes and self.possible(z3.Not(condition)):
                raise Fork([condition, z3.Not(condition)])
            # The condition is kept with the answer: its number would be used again for another one.
            self.decided[key] = (yes, condition)
        return self.decided[key][0]


# What an operation of the processor is, for words that are known and for z3 alike.
def mask(width):
    return (1 << width) - 1


def signed(value, width):
    return value - (1 << width) if value >> (width - 1) else value


def longer(value, by):
    """A word with zeros before it."""
    return z3.BitVecVal(value, 32 + by) if isinstance(value, int) else z3.ZeroExt(by, symbolic(value, 32))


def leading_zeros(value):
    if isinstance(value, int):
        return 32 - value.bit_length()
    value, found = symbolic(value, 32), z3.BitVecVal(32, 32)
    for place in range(32):
        found = z3.If(z3.Extract(place, place, value) == 1, z3.BitVecVal(31 - place, 32), found)
    return found


def truth(condition):
    """A condition as a number of one bit."""
    return int(condition) if isinstance(condition, bool) else z3.If(condition, z3.BitVecVal(1, 1), z3.BitVecVal(0, 1))


def as_condition(value, width=1):
    if isinstance(value, int):
        return value != 0
    if z3.is_app_of(value, z3.Z3_OP_ITE) and all(z3.is_bv_value(value.arg(i)) for i in (1, 2)):
        a, b = (value.arg(i).as_long() for i in (1, 2))
        if a and not b:
            return value.arg(0)
        if b and not a:
            return z3.Not(value.arg(0))
    return symbolic(value, width) != 0


BINARY = {
    "Add": (lambda a, b, w: a + b, lambda a, b: a + b),
    "Sub": (lambda a, b, w: a - b, lambda a, b: a - b),
    "Mul": (lambda a, b, w: a * b, lambda a, b: a * b),
    "And": (lambda a, b, w: a & b, lambda a, b: a & b),
    "Or": (lambda a, b, w: a | b, lambda a, b: a | b),
    "Xor": (lambda a, b, w: a ^ b, lambda a, b: a ^ b),
}
COMPARE = {
    "CmpEQ": (lambda a, b: a == b, lambda a, b: a == b),
    "CmpNE": (lambda a, b: a != b, lambda a, b: a != b),
    "CmpLTU": (lambda a, b: a < b, z3.ULT),
    "CmpLEU": (lambda a, b: a <= b, z3.ULE),
}
SHIFT = {
    "Shl": (lambda a, n, w: a << n if n < w else 0, lambda a, n: a << n),
    "Shr": (lambda a, n, w: a >> n if n < w else 0, z3.LShR),
    "Sar": (lambda a, n, w: signed(a, w) >> min(n, w - 1), lambda a, n: a >> n),
}


def flags(op, a, b, c):
    """N, Z, C and V as conditions, of what VEX keeps in place of them: an operation and its operands."""
    if not isinstance(op, int):
        raise NotImplementedError("flags of an operation that is not known")
    known = all(isinstance(x, int) for x in (a, b, c))

    def bit(value, place):
        return bool(value >> place & 1) if isinstance(value, int) else z3.Extract(place, place, value) == 1

    def below(x, y):
        return x < y if isinstance(x, int) and isinstance(y, int) else z3.ULT(symbolic(x, 32), symbolic(y, 32))

    def equal(x, y):
        return symbolic(x, 32) == symbolic(y, 32) if not (isinstance(x, int) and isinstance(y, int)) else x == y

    def both(condition, x, y):
        return (x if condition else y) if isinstance(condition, bool) else z3.If(condition, x, y)

    def negation(x):
        return not x if isinstance(x, bool) else z3.Not(x)

    a, b, c = (x if isinstance(x, int) else symbolic(x, 32) for x in (a, b, c))
    cut = (lambda x: x & WORD) if known else (lambda x: x & WORD if isinstance(x, int) else x)
    if op == 0:
        return bit(a, 31), bit(a, 30), bit(a, 29), bit(a, 28)
    if op in (1, 3):
        before = 0 if op == 1 else c & 1
        result = cut(a + b + before)
        over = bit(cut((result ^ a) & (result ^ b)), 31)
        if known:
            carry = a + b + before > WORD
        else:
            carry = bit(longer(a, 1) + longer(b, 1) + longer(before, 1), 32)
        return bit(result, 31), equal(result, 0), carry, over
    if op in (2, 4):
        result = cut(a - b) if op == 2 else cut(a - b - ((c & 1) ^ 1))
        over = bit(cut((a ^ b) & (a ^ result)), 31)
        if op == 2:
            return bit(result, 31), equal(a, b), negation(below(a, b)), over
        kept = bit(c, 0)
        return bit(result, 31), equal(result, 0), both(kept, negation(below(a, b)), below(b, a)), over
    if op == 5:
        return bit(a, 31), equal(a, 0), bit(b, 0), bit(c, 0)
    raise NotImplementedError(f"flags of the operation {op}")


def condition_of(code, n, z, c, v):
    def no(x):
        return not x if isinstance(x, bool) else z3.Not(x)

    def same(x, y):
        return x == y if isinstance(x, bool) and isinstance(y, bool) else z3.BoolVal(x) == y if isinstance(x, bool) else x == y

    def all_of(x, y):
        if isinstance(x, bool):
            return y if x else False
        if isinstance(y, bool):
            return x if y else False
        return z3.And(x, y)

    found = {
        0: lambda: z,
        2: lambda: c,
        4: lambda: n,
        6: lambda: v,
        8: lambda: all_of(c, no(z)),
        10: lambda: same(n, v),
        12: lambda: all_of(no(z), same(n, v)),
        14: lambda: True,
    }[code & ~1]()
    return no(found) if code & 1 else found


class Machine:
    """Runs functions of an image."""

    def __init__(self, image):
        self.image = image
        self.hooks = {}
        self.objects = []
        self.place_of = None
        self.steps = 0
        arithmetic = {
            "__aeabi_dadd": terms.total,
            "__aeabi_dsub": terms.difference,
            "__aeabi_dmul": terms.product,
            "__aeabi_ddiv": terms.quotient,
        }
        for name, function in arithmetic.items():
            if name in image.functions:
                self.hooks[image.functions[name]] = lambda path, f=function: self.arithmetic(path, f)
        for name, op, swap in (
            ("__aeabi_dcmplt", "lt", False),
            ("__aeabi_dcmple", "le", False),
            ("__aeabi_dcmpgt", "lt", True),
            ("__aeabi_dcmpge", "le", True),
            ("__aeabi_dcmpeq", "eq", False),
            ("__aeabi_dcmpun", "un", False),
        ):
            if name in image.functions:
                self.hooks[image.functions[name]] = lambda path, o=op, s=swap: self.comparison(path, o, s)
        for name, address in image.functions.items():
            if name.startswith("__aeabi_memclr"):
                self.hooks[address] = self.clear
            elif name.startswith(("__aeabi_memcpy", "__aeabi_memmove")):
                self.hooks[address] = self.move
            elif "rust_begin_unwind" in name:
                self.hooks[address] = self.panics
            elif name.startswith("library_"):
                self.hooks[address] = lambda path, o=name.removeprefix("library_"): self.library(path, o)

    # Functions of the run-time library.
    def arithmetic(self, path, function):
        a, b = (of_bits(joined(self.get(path, f"r{i}", 32), self.get(path, f"r{i + 1}", 32))) for i in (0, 2))
        result = function(a, b)
        self.put(path, "r0", lower(result), 32)
        self.put(path, "r1", upper(result), 32)

    def comparison(self, path, op, swap):
        a, b = (of_bits(joined(self.get(path, f"r{i}", 32), self.get(path, f"r{i + 1}", 32))) for i in (0, 2))
        if swap:
            a, b = b, a
        self.put(path, "r0", z3.If(compared(op, a, b), z3.BitVecVal(1, 32), z3.BitVecVal(0, 32)), 32)

    def library(self, path, op):
        argument = of_bits(self.get(path, "d0", 64))
        self.put(path, "d0", Float(op, argument), 64)

    def clear(self, path):
        start, length = self.get(path, "r0", 32), self.get(path, "r1", 32)
        length = self.known(path, length)
        for at in range(0, length, 4):
            self.store(path, start + at & WORD, 0, 32)

    def move(self, path):
        to, source, length = (self.get(path, f"r{i}", 32) for i in range(3))
        length = self.known(path, length)
        if length % 4:
            raise NotImplementedError("a copy of a part of a word")
        words = [self.load(path, source + at & WORD, 32) for at in range(0, length, 4)]
        for at, word in enumerate(words):
            self.store(path, to + 4 * at & WORD, word, 32)

    def panics(self, path):
        raise Violation("the code panics")

    # Registers: words by their offset.
    def get(self, path, name, width):
        return self.get_at(path, REGISTER[name], width)

    def get_at(self, path, offset, width):
        registers = path.registers
        if offset not in registers:
            registers[offset] = z3.BitVec(f"before_{NAMES.get(offset, offset)}", 32)
        if width == 64:
            if offset + 4 not in registers:
                registers[offset + 4] = z3.BitVec(f"before_{offset + 4}", 32)
            return joined(registers[offset], registers[offset + 4])
        return registers[offset]

    def put(self, path, name, value, width):
        self.put_at(path, REGISTER[name], value, width)

    def put_at(self, path, offset, value, width):
        if width == 64:
            path.registers[offset], path.registers[offset + 4] = lower(value), upper(value)
        else:
            path.registers[offset] = value

    # Memory: words by their address.
    def known(self, path, value):
        """A word whose value the path knows; divides the path where there are several."""
        if isinstance(value, int):
            return value
        found = []
        solver = z3.SolverFor("QF_BV")
        solver.add(*path.conditions)
        while solver.check() == z3.sat:
            number = solver.model().eval(value, model_completion=True).as_long()
            found.append(number)
            solver.add(value != number)
            if len(found) > 200:
                raise Violation(f"an address or length may have more than 200 values: {value}")
        if len(found) > 1:
            raise Fork([value == number for number in found])
        return found[0]

    def place(self, path, address, write, size):
        """The address as a key of memory, once it is known to lie in an object."""
        if not isinstance(address, int):
            if self.place_of and (key := self.place_of(path, address)):
                return key
            address = self.known(path, address)
        for start, length, writable in self.objects:
            if start <= address and address + size <= start + length and (writable or not write):
                return address
        if not write and self.image.read(address, size) is not None:
            return address
        raise Violation(f"{'writes' if write else 'reads'} {size} bytes at {address:#x}, outside of every object")

    def load(self, path, address, width):
        if width == 64:
            first = self.load(path, address, 32)
            return joined(first, self.load(path, address + 4 & WORD if isinstance(address, int) else address + 4, 32))
        key = self.place(path, address, False, width // 8)
        if isinstance(key, int) and width < 32:
            word = self.word(path, key & ~3)
            shift = 8 * (key & 3)
            if isinstance(word, int):
                return word >> shift & mask(width)
            return z3.Extract(shift + width - 1, shift, symbolic(word, 32))
        if isinstance(key, int) and key % 4:
            raise NotImplementedError("a word at an odd place")
        return self.word(path, key)

    def word(self, path, key):
        if key not in path.memory:
            constant = self.image.read(key, 4) if isinstance(key, int) else None
            if constant is not None:
                return int.from_bytes(constant, "little")
            name = f"memory_{key:x}" if isinstance(key, int) else f"memory_{key}"
            path.memory[key] = z3.BitVec(name, 32)
        return path.memory[key]

    def store(self, path, address, value, width):
        if width == 64:
            self.store(path, address, lower(value), 32)
            self.store(path, address + 4 & WORD if isinstance(address, int) else address + 4, upper(value), 32)
            return
        key = self.place(path, address, True, width // 8)
        if width < 32:
            word, shift = symbolic(self.word(path, key & ~3), 32), 8 * (key & 3)
            kept = word & (WORD ^ mask(width) << shift)
            value = z3.simplify(kept | z3.ZeroExt(32 - width, symbolic(value, width)) << shift)
            key &= ~3
        path.memory[key] = value
        path.written.add(key)

    # Expressions.
    def unary(self, op, a, path):
        if op in ("Iop_ReinterpF64asI64", "Iop_ReinterpI64asF64"):
            return a
        if op == "Iop_64to32":
            return lower(a)
        if op == "Iop_64HIto32":
            return upper(a)
        if op.startswith("Iop_Not"):
            width = int(op[7:])
            return ~a & mask(width) if isinstance(a, int) else ~symbolic(a, width)
        if "to" in op and op[4].isdigit():
            source, target = op[4:].split("to")
            is_signed = target.endswith("S") or source.endswith("S")
            source, target = int(source.strip("US")), int(target.strip("US"))
            if isinstance(a, int):
                return (signed(a, source) if is_signed else a) & mask(target)
            a = symbolic(a, source)
            if target <= source:
                # A condition that was made a word and is made a bit again.
                if target == 1 and z3.is_app_of(a, z3.Z3_OP_ITE) and all(z3.is_bv_value(a.arg(i)) for i in (1, 2)):
                    return z3.If(a.arg(0), *(z3.BitVecVal(a.arg(i).as_long() & 1, 1) for i in (1, 2)))
                return z3.Extract(target - 1, 0, a)
            return z3.SignExt(target - source, a) if is_signed else z3.ZeroExt(target - source, a)
        if op in ("Iop_Clz32", "Iop_ClzNat32"):
            return leading_zeros(a)
        raise NotImplementedError(op)

    def binary(self, op, a, b):
        name = op[4:]
        if name in ("32HLto64",):
            return joined(b, a)
        if name == "MullU32":
            if isinstance(a, int) and isinstance(b, int):
                return a * b
            return longer(a, 32) * longer(b, 32)
        for start, (numbers, words) in SHIFT.items():
            if name.startswith(start) and name[len(start) :].isdigit():
                width = int(name[len(start) :])
                if isinstance(a, int) and isinstance(b, int):
                    return numbers(a, b, width) & mask(width)
                b = z3.BitVecVal(b, width) if isinstance(b, int) else z3.ZeroExt(width - 8, symbolic(b, 8))
                return words(symbolic(a, width), b)
        width = next((w for w in (32, 64, 16, 8, 1) if str(w) in name), None)
        start = name.replace(str(width), "")
        if start == "Xor" and (isinstance(a, Half) or isinstance(b, Half)):
            half, other = (a, b) if isinstance(a, Half) else (b, a)
            if half.upper and isinstance(other, int) and other == 1 << 31:
                return Half(terms.negated(half.of), True)
        if start in COMPARE:
            numbers, words = COMPARE[start]
            if isinstance(a, int) and isinstance(b, int):
                return truth(numbers(a, b))
            return truth(words(symbolic(a, width), symbolic(b, width)))
        if start in BINARY:
            numbers, words = BINARY[start]
            if isinstance(a, int) and isinstance(b, int):
                return numbers(a, b, width) & mask(width)
            return words(symbolic(a, width), symbolic(b, width))
        raise NotImplementedError(op)

    def evaluate(self, path, e, temporaries, types):
        kind = type(e)
        if kind is pyvex.expr.RdTmp:
            return temporaries[e.tmp]
        if kind is pyvex.expr.Const:
            value = e.con.value
            if isinstance(value, float):
                return struct.unpack("<Q", struct.pack("<d", value))[0]
            return int(value)
        if kind is pyvex.expr.Get:
            return self.get_at(path, e.offset, 64 if e.ty in ("Ity_I64", "Ity_F64") else 32)
        if kind is pyvex.expr.Load:
            address = self.evaluate(path, e.addr, temporaries, types)
            return self.load(path, address, int(e.ty.removeprefix("Ity_")[1:]))
        if kind is pyvex.expr.Unop:
            return self.unary(e.op, self.evaluate(path, e.args[0], temporaries, types), path)
        if kind is pyvex.expr.Binop:
            return self.binary(e.op, *(self.evaluate(path, a, temporaries, types) for a in e.args))
        if kind is pyvex.expr.ITE:
            condition = as_condition(self.evaluate(path, e.cond, temporaries, types))
            chosen = e.iftrue if path.decide(condition) else e.iffalse
            return self.evaluate(path, chosen, temporaries, types)
        if kind is pyvex.expr.CCall:
            arguments = [self.evaluate(path, a, temporaries, types) for a in e.args]
            if e.callee.name == "armg_calculate_condition":
                code = arguments[0]
                if not isinstance(code, int):
                    raise NotImplementedError("a condition that is not known")
                if code >> 4 == 14:
                    return 1
                found = condition_of(code >> 4, *flags(code & 15, *arguments[1:]))
            elif e.callee.name == "armg_calculate_flag_c":
                found = flags(*arguments)[2]
            elif e.callee.name == "armg_calculate_flag_v":
                found = flags(*arguments)[3]
            else:
                raise NotImplementedError(e.callee.name)
            return int(found) if isinstance(found, bool) else z3.If(found, z3.BitVecVal(1, 32), z3.BitVecVal(0, 32))
        raise NotImplementedError(str(e))

    def guarded(self, path, conversion, address):
        """What a load on a condition gives."""
        conversion = conversion.removeprefix("ILGop_")
        if conversion.startswith("Ident"):
            return self.load(path, address, int(conversion.removeprefix("Ident")))
        source, is_signed = int(conversion.split("to")[0].strip("US")), "S" in conversion
        return self.unary(f"Iop_{source}{'S' if is_signed else 'U'}to32", self.load(path, address, source), path)

    def step(self, path, address):
        """Executes a block; gives the address of the next."""
        block = self.image.block(address)
        temporaries = {}
        types = block.tyenv

        def value(e):
            return self.evaluate(path, e, temporaries, types)

        for s in block.statements:
            kind = type(s)
            if kind is pyvex.stmt.WrTmp:
                temporaries[s.tmp] = value(s.data)
            elif kind is pyvex.stmt.Put:
                width = 64 if s.data.result_type(types) in ("Ity_I64", "Ity_F64") else 32
                self.put_at(path, s.offset, value(s.data), width)
            elif kind is pyvex.stmt.Store:
                self.store(path, value(s.addr), value(s.data), int(s.data.result_type(types).removeprefix("Ity_")[1:]))
            elif kind is pyvex.stmt.LoadG:
                if path.decide(as_condition(value(s.guard), 1)):
                    temporaries[s.dst] = self.guarded(path, s.cvt, value(s.addr))
                else:
                    temporaries[s.dst] = value(s.alt)
            elif kind is pyvex.stmt.StoreG:
                if path.decide(as_condition(value(s.guard), 1)):
                    width = int(s.data.result_type(types).removeprefix("Ity_")[1:])
                    self.store(path, value(s.addr), value(s.data), width)
            elif kind is pyvex.stmt.Exit:
                if path.decide(as_condition(value(s.guard), 1)):
                    if s.jk not in ("Ijk_Boring", "Ijk_Call"):
                        raise NotImplementedError(s.jk)
                    return s.dst.value
            elif kind not in (pyvex.stmt.IMark, pyvex.stmt.AbiHint, pyvex.stmt.NoOp):
                raise NotImplementedError(str(s))
        if block.jumpkind not in ("Ijk_Boring", "Ijk_Call", "Ijk_Ret"):
            raise NotImplementedError(f"{block.jumpkind} at {address:#x}")
        return self.known(path, value(block.next))

    def run(self, name, arguments, path=None):
        """All paths of a call, each after its return. `arguments`: words; from the fifth on they lie on the stack."""
        path = path.copy() if path else Path()
        path.written = set()
        path.registers = {REGISTER["itstate"]: 0, REGISTER["cc_op"]: 0}
        for register in ("cc_dep1", "cc_dep2", "cc_ndep"):
            path.registers[REGISTER[register]] = 0
        top = STACK + STACK_SIZE - 64
        stack = (STACK, STACK_SIZE, True)
        if stack not in self.objects:
            self.objects.append(stack)
        path.memory = {k: v for k, v in path.memory.items() if not (isinstance(k, int) and STACK <= k < STACK + STACK_SIZE)}
        for i, argument in enumerate(arguments):
            if i < 4:
                self.put(path, f"r{i}", argument, 32)
            else:
                path.memory[top + 4 * (i - 4)] = argument
        self.put(path, "sp", top, 32)
        self.put(path, "lr", RETURN | 1, 32)
        done, waiting = [], [(path, self.image.functions[name], 0)]
        while waiting:
            path, address, count = waiting.pop()
            while True:
                if address & ~1 == RETURN:
                    done.append(path)
                    break
                address &= ~1
                before = path.copy()
                try:
                    if address in self.hooks:
                        back = self.get(path, "lr", 32)
                        self.hooks[address](path)
                        address = back
                    else:
                        address = self.step(path, address)
                except Fork as fork:
                    for condition in fork.conditions:
                        branch = before.copy()
                        branch.conditions.append(condition)
                        waiting.append((branch, address, count))
                    break
                count += 1
                self.steps += 1
                if count > LONGEST:
                    raise Violation(f"{name} does not end within {LONGEST} blocks")
        return done


def compared(op, a, b):
    """A comparison of two floating-point numbers, exactly as IEEE 754 has it, on their bits."""
    a, b = terms.bits(a), terms.bits(b)

    def size(x):
        return x & (1 << 63) - 1

    def in_order(x):
        return z3.If(z3.Extract(63, 63, x) == 1, -size(x), size(x))

    numbers = z3.And(*(z3.ULE(size(x), 0x7FF << 52) for x in (a, b)))
    if op == "un":
        return z3.Not(numbers)
    a, b = in_order(a), in_order(b)
    return z3.And(numbers, {"lt": a < b, "le": a <= b, "eq": a == b}[op])
