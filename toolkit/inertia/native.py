"""Compiled kernels without the compiler: numba makes the machine code once, a few lines load it afterwards.

Importing numba costs more CPU time than integrating ten million triangles, so it is imported only to compile; and
importing llvmlite as much as integrating one million, and 55 MB, so that it links only what the lines here do not
know: anything but ELF code for x86-64 (Linux).
For Linux on any x86-64 processor since 2013 or so (the level v3 of the psABI: AVX2, FMA) the machine code lies in the
folder `compiled` beside this module, under a name that is a hash of the kernel's source; of what gains by vectors of
512 bits, there is machine code for these too. Elsewhere it is kept in the user's cache folder (`inertia.user_cache`),
under a name that is a hash of the source, the versions and the processor. From there it is loaded from the very bytes
that were checked to be this user's own; what is damaged is made again, and where there is no cache to trust, the kernel
is compiled for this process: one `CacheWarning` says so, and the answer is the same.

A kernel is a Python function over pointers and numbers, in a module that imports nothing but numba, numpy, tables of
coefficients and other kernels. It may not allocate, raise or call Python, and it returns an int64. What it calls must
become part of it (`inline="always"` or `forceinline=True`): a call that is left in the machine code leads nowhere when
that is loaded.
Set `INERTIA_NATIVE=0` to do without compiled kernels: the numpy paths give the same bits, more slowly; but for the
Taylor method, DOP853 and sums over more than 1,024 triangles, which they give to rounding.
"""

from __future__ import annotations

import contextlib
import ctypes
import functools
import hashlib
import importlib
import importlib.util
import itertools
import mmap
import os
import struct
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from inertia import user_cache
from inertia.errors import CacheWarning

COMPILE_ABOVE = 400_000
"""Triangles above which compiling (about 2 s, once for a machine) costs less than doing without."""

LOAD_ABOVE = 20_000
"""Triangles above which loading machine code from the cache (0.08 s with LLVM) costs less than doing without."""

SHIPPED_ABOVE = 1_000
"""Triangles above which loading machine code that is shipped (0.5 ms) costs less than doing without."""

SHIPPED = Path(__file__).with_name("compiled")
"""The machine code for Linux on x86-64 processors, by `Level`; ``tests/compile_kernels.py`` writes it."""


class Level(NamedTuple):
    """What a processor can do: a name and features as LLVM has them, and flags as Linux does."""

    name: str
    features: str
    flags: frozenset[str]


LEVEL = Level("x86-64-v3", "", frozenset(("abm", "avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "movbe")))
WIDE = Level(
    "x86-64-v4",
    "-prefer-256-bit",
    LEVEL.flags | {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl", "avx512_vbmi2"},
)
"""Vectors of 512 bits; the last flag is of processors that do not slow down for them (Ice Lake, Zen 4 and later)."""

_CTYPES: dict[str, Any] = {"p": ctypes.c_void_p, "i": ctypes.c_int64, "d": ctypes.c_double}

_NEVER_CALLED = ("numba_gil_ensure", "numba_gil_release", "NRT_MemInfo_call_dtor")
"""Symbols that numba's wrapper refers to on its way out of an exception; no kernel raises one."""

_ALLOCATED, _WRITABLE = 2, 1  # flags of a section in an ELF file
_CONTENTS, _RELOCATIONS, _SYMBOLS = 1, 4, 2  # kinds of section
_ABSOLUTE_64, _RELATIVE_64 = 1, 24  # kinds of relocation, of x86-64

_MOST_THREADS = 8  # more wait for memory

_loaded: list[Any] = []
"""Memory and engines of LLVM that hold machine code, which lives as long as they do."""

_UNUSED = "compiled kernels are not kept: {}: set INERTIA_CACHE to a folder of your own that can be written to"
_DAMAGED = "a compiled kernel in the cache was damaged, or is not from here: it is compiled again"


class Kernel:
    """A compiled function: `module` and `name` say where its Python source is, `abi` what it takes.

    `abi` has one letter an argument: `p` a pointer (the address of a contiguous array), `i` an int64, `d` a
    float64. Where the kernel is `fused`, a product and the addition of it may round once, and statements that stand
    side by side become vector instructions: faster, but its bits are those of the processor. Of one that works on
    rows of lanes, machine code is also shipped for `wide` vectors, which gives the same bits.
    """

    def __init__(self, module: str, name: str, abi: str, *, fused: bool = False, wide: bool = False) -> None:
        self.module, self.name, self.abi, self.fused = module, name, abi, fused
        self.levels = (WIDE, LEVEL) if wide else (LEVEL,)
        self._asked = 0

    def worthwhile(self, count: int) -> bool:
        """Say whether the work on `count` triangles repays compiling or loading the kernel.

        What was asked before counts too: a loop over small parts is as much work as a large part.
        """
        if os.environ.get("INERTIA_NATIVE") == "0":
            return False
        if "function" in self.__dict__:
            return True
        self._asked += count
        count = self._asked
        if count < SHIPPED_ABOVE:
            return False
        if self._shipped is not None:
            return True
        if count < LOAD_ABOVE:
            return False
        code = self._kept
        return bool(code) or ((code is not None or count >= COMPILE_ABOVE) and _has_compiler())

    @property
    def is_shipped(self) -> bool:
        """Whether machine code for this processor is shipped."""
        return self._shipped is not None

    @functools.cached_property
    def function(self) -> Callable[..., int]:
        """The C function; the first use on a machine compiles it."""
        return _link(self._symbol, self._shipped or self._load() or self._compile(), self.abi)

    def shipped_as(self, level: Level = LEVEL) -> Path:
        """Return the file that holds its machine code where it is shipped; its name follows from the source."""
        return SHIPPED / f"{self.name}-{self._key(*filter(None, level[:2]))}.kernel"

    @functools.cached_property
    def _shipped(self) -> bytes | None:
        for level in self.levels:
            if of_shipped_level(level):
                with contextlib.suppress(OSError):
                    return self.shipped_as(level).read_bytes()
        return None

    @functools.cached_property
    def _kept(self) -> bytes | None:
        return self._load()  # once, as loops ask often

    @property
    def _symbol(self) -> str:
        return f"inertia_{self.name}"

    def _load(self) -> bytes | None:
        """Return the machine code in the cache, nothing (b"") where it is damaged, None where there is none to use."""
        try:
            code = user_cache.load(self._file)
        except user_cache.CacheError as error:
            _warn(_UNUSED.format(error))
            return None
        if code == b"":
            _warn(_DAMAGED)
        return code

    @functools.cached_property
    def _file(self) -> str:
        return f"{self.name}-{self._key(*_compiler_and_processor())}.kernel"

    def _key(self, *made_for: str) -> str:
        spec = importlib.util.find_spec(self.module)
        if spec is None or spec.origin is None:
            raise ModuleNotFoundError(self.module)
        sources = sorted(Path(spec.origin).parent.glob("*_kernel.py"))  # kernels share functions
        text = b"".join(map(Path.read_bytes, sources)) + repr((self.abi, self.fused, *made_for)).encode()
        return hashlib.sha256(text).hexdigest()[:16]

    def _compile(self) -> bytes:
        code = self.machine_code()
        try:
            user_cache.store(self._file, code)
        except user_cache.CacheError as error:
            _warn(_UNUSED.format(error))
        return code

    def machine_code(self, level: Level | None = None) -> bytes:
        """Compile the kernel: object code for processors of a level, None for the one at hand."""
        import llvmlite.binding as llvm
        import numba

        kinds = {"p": numba.types.voidptr, "i": numba.types.int64, "d": numba.types.float64}
        signature = numba.types.int64(*(kinds[letter] for letter in self.abi))
        disabled, numba.config.DISABLE_JIT = numba.config.DISABLE_JIT, 0  # by the user's setting, for other code
        try:
            source = getattr(importlib.import_module(self.module), self.name)
            contract = {"contract"} if self.fused else False
            compiled = numba.cfunc(signature, error_model="numpy", fastmath=contract)(source)
        finally:
            numba.config.DISABLE_JIT = disabled
        module, machine = llvm.parse_assembly(compiled.inspect_llvm()), _machine(level)
        module.get_function(compiled.native_name).name = self._symbol
        if self.fused:
            _vectorise(module, machine)
        code: bytes = machine.emit_object(module)
        return code


def _has_compiler() -> bool:
    try:
        import numba  # noqa: F401  # it refuses a numpy that is newer than itself
    except ImportError as error:
        _warn(f"kernels are not compiled, which costs time: numba cannot be imported ({error}): install it again")
        return False
    return True


def _warn(message: str) -> None:
    warnings.warn(message, CacheWarning, stacklevel=2)


def address(array: Any) -> int:
    """Return where a contiguous array that may be written to lies; five times as fast as the array's own attribute."""
    return ctypes.addressof(ctypes.c_char.from_buffer(array))


def place(array: Any) -> int:
    """Return where any contiguous array lies."""
    try:
        return address(array)
    except (TypeError, ValueError):  # it is read-only, or empty
        return int(array.ctypes.data)


def threads() -> int:
    """Return how many threads may run kernels at once: one a processor, or as few as the environment allows."""
    processors = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    limits = (os.environ.get(name, "").split(",")[0] for name in ("OMP_NUM_THREADS", "NUMBA_NUM_THREADS"))
    return max(1, min([processors, _MOST_THREADS, *(int(limit) for limit in limits if limit.strip().isdigit())]))


def _machine(level: Level | None = None) -> Any:
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    if level is None:
        name, features = llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()
    else:
        name, features, _ = level
    target = llvm.Target.from_default_triple()
    return target.create_target_machine(cpu=name, features=features, opt=3, jit=True)


def _vectorise(module: Any, machine: Any) -> None:
    """Run LLVM's passes once more with the vectoriser of straight-line code (SLP), which numba leaves out."""
    import llvmlite.binding as llvm

    tuning = llvm.create_pipeline_tuning_options(speed_level=3)
    tuning.slp_vectorization = True
    builder = llvm.create_pass_builder(machine, tuning)
    builder.getModulePassManager().run(module, builder)


@functools.cache
def processor_lines() -> tuple[str, ...]:
    """Return the lines in which Linux describes the processor; none on other systems."""
    with contextlib.suppress(OSError), Path("/proc/cpuinfo").open(encoding="utf-8") as lines:
        first = itertools.takewhile(str.strip, lines)
        return tuple(line for line in first if line.startswith(("vendor_id", "cpu family", "model", "flags")))
    return ()


def of_shipped_level(level: Level = LEVEL) -> bool:
    """Say whether the machine code that is shipped for a level runs here."""
    flags = next((line for line in processor_lines() if line.startswith("flags")), "")
    return sys.platform == "linux" and level.flags.issubset(flags.split())


def _compiler_and_processor() -> tuple[str, ...]:
    """Return what machine code depends on; each llvmlite is made for one numba, so that its version stands for both."""
    spec = importlib.util.find_spec("llvmlite")
    with contextlib.suppress(OSError):
        if spec is not None and spec.origin is not None and any(line.startswith("flags") for line in processor_lines()):
            return Path(spec.origin).with_name("_version.py").read_text(encoding="utf-8"), *processor_lines()
    import llvmlite
    import llvmlite.binding as llvm

    return llvmlite.__version__, llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()


def _link(symbol: str, code: bytes, abi: str) -> Callable[..., int]:
    prototype = ctypes.CFUNCTYPE(ctypes.c_int64, *(_CTYPES[letter] for letter in abi))
    return prototype(_link_here(symbol, code) or _link_by_llvm(symbol, code))


def _link_here(symbol: str, code: bytes) -> int | None:
    """Put ELF object code for x86-64 into memory and return where the function `symbol` is; None for anything else.

    M. Matz et al., "System V Application Binary Interface: AMD64 Architecture Processor Supplement", §4.
    """
    if sys.platform != "linux" or code[:6] != b"\x7fELF\2\1" or code[16:20] != b"\1\0\x3e\0":
        return None
    (headers,), (count,) = struct.unpack_from("<Q", code, 40), struct.unpack_from("<H", code, 60)
    sections = [struct.unpack_from("<4xIQ8xQQIIQ8x", code, headers + 64 * number) for number in range(count)]
    places, size = {}, 0
    for number, (kind, flags, _, length, _, _, alignment) in enumerate(sections):
        if kind == _CONTENTS and flags & _ALLOCATED:
            if flags & _WRITABLE:
                return None
            places[number] = size = -(-size // max(alignment, 1)) * max(alignment, 1)
            size += length
    memory = mmap.mmap(-1, size)
    base = address(memory)
    for number, place in places.items():
        _, _, start, length, *_ = sections[number]
        memory[place : place + length] = code[start : start + length]
    symbols = {}
    for kind, _, start, length, names, _, _ in sections:
        if kind == _SYMBOLS:
            for number, (at, of, value) in enumerate(struct.iter_unpack("<I2xHQ8x", code[start : start + length])):
                at += sections[names][2]
                name = code[at : code.index(b"\0", at)].decode()
                symbols[number] = name, base + places[of] + value if of in places else None if of else _outside(name)
    for kind, _, start, length, _, of, _ in sections:
        if kind == _RELOCATIONS and of in places:
            for at, how, number, addend in struct.iter_unpack("<QIIq", code[start : start + length]):
                _, target = symbols[number]
                if target is None or how not in (_ABSOLUTE_64, _RELATIVE_64):
                    return None
                value = target + addend - (base + places[of] + at if how == _RELATIVE_64 else 0)
                struct.pack_into("<Q", memory, places[of] + at, value % 2**64)
    if ctypes.pythonapi.mprotect(ctypes.c_void_p(base), ctypes.c_size_t(size), mmap.PROT_READ | mmap.PROT_EXEC):
        return None
    _loaded.append(memory)
    return next((target for name, target in symbols.values() if name == symbol), None)


def _outside(name: str) -> int | None:
    """Return the address of what the process holds already: Python's own functions and the C library's."""
    try:
        return ctypes.cast(ctypes.pythonapi["PyErr_Clear" if name in _NEVER_CALLED else name], ctypes.c_void_p).value
    except AttributeError:
        return None


def _link_by_llvm(symbol: str, code: bytes) -> int:
    import llvmlite.binding as llvm

    for name in _NEVER_CALLED:
        llvm.add_symbol(name, _outside(name))
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _machine())
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    _loaded.append(engine)
    where: int = engine.get_function_address(symbol)
    return where
