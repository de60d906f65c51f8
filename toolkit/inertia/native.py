"""Compiled kernels without the compiler: numba makes the machine code once, llvmlite loads it afterwards.

Importing numba costs more CPU time than integrating ten million triangles, so it is imported only to compile.
The machine code is kept in the user's cache folder (`INERTIA_CACHE`, else `XDG_CACHE_HOME`/inertia, else
`~/.cache/inertia`), under a name that is a hash of the kernel's source, the versions and the processor; a file
that does not carry the checksum of its own contents is made again.

A kernel is a Python function over pointers and numbers, in a module that imports nothing but numba, numpy and other
kernels. It may not allocate, raise or call Python, and it returns an int64. What it calls must become part of it
(`inline="always"` or `forceinline=True`): a call that is left in the machine code leads nowhere when that is loaded.
Set `INERTIA_NATIVE=0` to do without compiled kernels: the numpy paths give the same bits (but for the Taylor method,
the same to rounding), more slowly.
"""

from __future__ import annotations

import contextlib
import ctypes
import functools
import importlib
import importlib.util
import json
import os
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

COMPILE_ABOVE = 400_000
"""Triangles above which compiling (about 2 s, once for a machine) costs less than doing without."""

LOAD_ABOVE = 20_000
"""Triangles above which loading machine code that is at hand (0.05 s) costs less than doing without."""

_CTYPES: dict[str, Any] = {"p": ctypes.c_void_p, "i": ctypes.c_int64, "d": ctypes.c_double}

_NEVER_CALLED = ("numba_gil_ensure", "numba_gil_release", "NRT_MemInfo_call_dtor")
"""Symbols that numba's wrapper refers to on its way out of an exception; no kernel raises one."""

_engines: list[Any] = []


class Kernel:
    """A compiled function: `module` and `name` say where its Python source is, `abi` what it takes.

    `abi` has one letter an argument: `p` a pointer (the address of a contiguous array), `i` an int64, `d` a
    float64. Where the kernel is `fused`, a product and the addition of it may round once, and statements that stand
    side by side become vector instructions: faster, but its bits are those of the processor.
    """

    def __init__(self, module: str, name: str, abi: str, *, fused: bool = False) -> None:
        self.module, self.name, self.abi, self.fused = module, name, abi, fused

    def worthwhile(self, count: int) -> bool:
        """Say whether the work on `count` triangles repays compiling or loading the kernel."""
        if os.environ.get("INERTIA_NATIVE") == "0":
            return False
        if "function" in self.__dict__:
            return True
        return count >= COMPILE_ABOVE or (count >= LOAD_ABOVE and self._file.exists())

    @functools.cached_property
    def function(self) -> Callable[..., int]:
        """The C function; the first use on a machine compiles it."""
        symbol, code = _read(self._file) or self._compile()
        return _link(symbol, code, self.abi)

    @functools.cached_property
    def _file(self) -> Path:
        spec = importlib.util.find_spec(self.module)
        if spec is None or spec.origin is None:
            raise ModuleNotFoundError(self.module)
        import llvmlite
        import llvmlite.binding as llvm

        # Each llvmlite is made for one numba, so that its version stands for both.
        processor = llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()
        made_for = self.abi, self.fused, llvmlite.__version__, *processor
        sources = sorted(Path(spec.origin).parent.glob("*_kernel.py"))  # kernels share functions
        key = importlib.util.source_hash(b"".join(map(Path.read_bytes, sources)) + repr(made_for).encode())
        return _cache_folder() / f"{self.name}-{key.hex()}.o"

    def _compile(self) -> tuple[str, bytes]:
        import llvmlite.binding as llvm
        import numba

        kinds = {"p": numba.types.voidptr, "i": numba.types.int64, "d": numba.types.float64}
        signature = numba.types.int64(*(kinds[letter] for letter in self.abi))
        source = getattr(importlib.import_module(self.module), self.name)
        compiled = numba.cfunc(signature, error_model="numpy", fastmath={"contract"} if self.fused else False)(source)
        module, machine = llvm.parse_assembly(compiled.inspect_llvm()), _machine()
        if self.fused:
            _vectorise(module, machine)
        code = machine.emit_object(module)
        _write(self._file, compiled.native_name, code)
        return compiled.native_name, code


def address(array: Any) -> int:
    """Return where a contiguous array that may be written to lies; five times as fast as the array's own attribute."""
    return ctypes.addressof(ctypes.c_char.from_buffer(array))


def _cache_folder() -> Path:
    if folder := os.environ.get("INERTIA_CACHE"):
        return Path(folder)
    base = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    return (Path(base) if base else Path.home() / ".cache") / "inertia"


def _read(file: Path) -> tuple[str, bytes] | None:
    try:
        head, code = file.read_bytes().split(b"\n", 1)
        record = json.loads(head)
        if zlib.crc32(code) == record["crc32"]:
            return record["symbol"], code
    except (OSError, ValueError, KeyError, TypeError):
        pass
    return None


def _write(file: Path, symbol: str, code: bytes) -> None:
    import tempfile

    head = json.dumps({"symbol": symbol, "crc32": zlib.crc32(code)}).encode()
    with contextlib.suppress(OSError):  # a cache that cannot be written costs time, not the answer
        file.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=file.parent, delete=False) as beside:
            beside.write(head + b"\n" + code)
        try:
            Path(beside.name).replace(file)
        finally:
            Path(beside.name).unlink(missing_ok=True)


def _machine() -> Any:
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    features = llvm.get_host_cpu_features().flatten()
    target = llvm.Target.from_default_triple()
    return target.create_target_machine(cpu=llvm.get_host_cpu_name(), features=features, opt=3, jit=True)


def _vectorise(module: Any, machine: Any) -> None:
    """Run LLVM's passes once more with the vectoriser of straight-line code (SLP), which numba leaves out."""
    import llvmlite.binding as llvm

    tuning = llvm.create_pipeline_tuning_options(speed_level=3)
    tuning.slp_vectorization = True
    builder = llvm.create_pass_builder(machine, tuning)
    builder.getModulePassManager().run(module, builder)


def _link(symbol: str, code: bytes, abi: str) -> Callable[..., int]:
    import llvmlite.binding as llvm

    nothing = ctypes.cast(ctypes.pythonapi.PyErr_Clear, ctypes.c_void_p).value
    for name in _NEVER_CALLED:
        llvm.add_symbol(name, nothing)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _machine())
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    _engines.append(engine)  # the machine code lives as long as its engine
    prototype = ctypes.CFUNCTYPE(ctypes.c_int64, *(_CTYPES[letter] for letter in abi))
    return prototype(engine.get_function_address(symbol))
