"""The cache of compiled kernels: it may be absent, damaged or read-only, and the answer stays the same."""

import ctypes
import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest
from tests import compile_kernels

from inertia import native
from inertia.errors import CacheWarning
from inertia.mesh.geometry import closure, corner_keys, pairing, waiting_edges
from inertia.mesh.surface import Surface
from inertia.native import COMPILE_ABOVE, LOAD_ABOVE, SHIPPED_ABOVE, Kernel


def torus(around: int, along: int) -> Surface:
    """Return a closed torus of 2 × around × along triangles."""
    u, v = np.meshgrid(np.arange(around), np.arange(along), indexing="ij")
    a, b = 2 * np.pi * u / around, 2 * np.pi * v / along
    points = np.stack([(3 + np.cos(b)) * np.cos(a), (3 + np.cos(b)) * np.sin(a), np.sin(b)], axis=-1)
    here, beside = u * along + v, (u + 1) % around * along + v
    above, across = u * along + (v + 1) % along, (u + 1) % around * along + (v + 1) % along
    faces = np.stack([here, beside, across, here, across, above], axis=-1)
    return Surface(points.reshape(-1, 3), faces.reshape(-1, 3))


LARGE = torus(700, 300)
"""Enough triangles that compiling is worthwhile."""


def is_one_closed_piece(surface: Surface) -> bool:
    result = closure.closure(surface)
    return (result.open_edges, result.components, result.repeated) == (0, 1, 0) and not result.labels.any()


def forget_kernels(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make this process look for its kernels again, as another process would."""
    again: dict[Kernel, Kernel] = {}
    for module in (corner_keys, waiting_edges, pairing, closure):
        for name, kernel in vars(module).copy().items():
            if isinstance(kernel, Kernel):
                new = again.setdefault(kernel, Kernel(kernel.module, kernel.name, kernel.abi))
                monkeypatch.setattr(module, name, new)


def forbid_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "numba", None)


def forbid_llvm(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "llvmlite.binding", None)


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache, no kernel loaded, and none shipped."""
    folder = tmp_path / "cache"
    monkeypatch.setattr(native, "SHIPPED", tmp_path)
    monkeypatch.setenv("INERTIA_CACHE", str(folder))
    forget_kernels(monkeypatch)
    return folder


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What a first use leaves in the cache for the pairing of edges, beside the other kernels that it used."""
    with pytest.MonkeyPatch.context() as monkeypatch:
        folder = tmp_path_factory.mktemp("compiled")
        monkeypatch.setattr(native, "SHIPPED", folder)
        monkeypatch.setenv("INERTIA_CACHE", str(folder))
        forget_kernels(monkeypatch)
        assert is_one_closed_piece(LARGE)
        (file,) = folder.glob("pair_rows-*")
        return file


def put(cache: Path, compiled: Path, content: bytes) -> Path:
    shutil.copytree(compiled.parent, cache)
    file = cache / compiled.name
    file.write_bytes(content)
    return file


def test_what_one_process_compiled_the_next_loads_without_the_compiler(
    cache: Path, compiled: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = put(cache, compiled, compiled.read_bytes())
    forbid_compiler(monkeypatch)
    assert is_one_closed_piece(LARGE)
    assert file.read_bytes() == compiled.read_bytes()


@pytest.mark.skipif(
    sys.platform != "linux" or platform.machine() != "x86_64", reason="machine code that LLVM alone links"
)
def test_machine_code_is_linked_without_llvm(cache: Path, compiled: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    put(cache, compiled, compiled.read_bytes())
    forbid_llvm(monkeypatch)
    assert is_one_closed_piece(LARGE)


@pytest.mark.skipif(sys.platform != "linux", reason="memory is made executable in another way")
def test_llvm_links_where_memory_may_not_be_made_executable_here(
    cache: Path, compiled: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    put(cache, compiled, compiled.read_bytes())
    monkeypatch.setattr(ctypes.pythonapi, "mprotect", lambda *_: -1, raising=False)
    forbid_compiler(monkeypatch)
    assert is_one_closed_piece(LARGE)
    forget_kernels(monkeypatch)
    forbid_llvm(monkeypatch)
    with pytest.raises(ImportError, match="llvmlite"):
        closure.closure(LARGE)


@pytest.mark.parametrize(
    "damage",
    [lambda content: b"", lambda content: content[:-1], lambda content: bytes([content[0] ^ 1]) + content[1:]],
    ids=["empty", "truncated", "one bit flipped"],
)
def test_a_damaged_file_is_made_again(
    cache: Path, compiled: Path, monkeypatch: pytest.MonkeyPatch, damage: Callable[[bytes], bytes]
) -> None:
    put(cache, compiled, damage(compiled.read_bytes()))
    with pytest.warns(CacheWarning, match="damaged, or is not from here: it is compiled again"):
        assert is_one_closed_piece(LARGE)
    assert len(list(cache.iterdir())) == len(list(compiled.parent.iterdir()))
    forget_kernels(monkeypatch)
    forbid_compiler(monkeypatch)
    assert is_one_closed_piece(LARGE)


def test_a_cache_that_cannot_be_written_costs_no_answer(
    cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("not a folder")
    monkeypatch.setenv("INERTIA_CACHE", str(tmp_path / "file" / "cache"))
    with pytest.warns(CacheWarning, match="compiled kernels are not kept: .*: set INERTIA_CACHE to a folder of your"):
        assert is_one_closed_piece(LARGE)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_a_cache_that_others_may_write_to_is_not_loaded_from(
    cache: Path, compiled: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    put(cache, compiled, compiled.read_bytes())
    cache.chmod(0o777)
    with pytest.warns(CacheWarning, match="others may write to"):
        assert not corner_keys.FACES.worthwhile(LOAD_ABOVE)
    with pytest.warns(CacheWarning, match="others may write to"):
        assert is_one_closed_piece(LARGE)


def test_without_a_compiler_the_answer_is_the_same(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    forbid_compiler(monkeypatch)
    with pytest.warns(CacheWarning, match="kernels are not compiled, which costs time: numba cannot be imported"):
        assert is_one_closed_piece(LARGE)


def test_kernels_are_compiled_where_numba_is_switched_off_for_other_code(tmp_path: Path) -> None:
    program = """if True:
        from inertia.native import Kernel
        kernel = Kernel("inertia.mesh.geometry.edge_kernel", "key_vertices", "pipp")
        print(len(kernel.machine_code()) > 1000, __import__("numba").config.DISABLE_JIT)
    """
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1", "INERTIA_CACHE": str(tmp_path / "cache")}
    run = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True)
    assert run.stdout == "True 1\n"


def test_native_0_does_without_compiled_kernels(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("INERTIA_NATIVE", "0")
    forbid_compiler(monkeypatch)
    assert is_one_closed_piece(LARGE)
    assert not cache.exists()


def test_a_kernel_is_compiled_for_many_triangles_and_loaded_for_fewer(
    cache: Path, compiled: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def worthwhile() -> list[bool]:
        answers = []
        for count in (LOAD_ABOVE - 1, LOAD_ABOVE, COMPILE_ABOVE):
            forget_kernels(monkeypatch)
            answers.append(corner_keys.FACES.worthwhile(count))
        return answers

    assert worthwhile() == [False, False, True]
    forget_kernels(monkeypatch)
    assert [corner_keys.FACES.worthwhile(COMPILE_ABOVE // 2) for _ in range(3)] == [False, True, True]
    put(cache, compiled, compiled.read_bytes())
    assert worthwhile() == [False, True, True]
    monkeypatch.setenv("INERTIA_NATIVE", "0")
    assert worthwhile() == [False, False, False]


SHIPPED_HERE = native.of_shipped_level()


@pytest.mark.skipif(not SHIPPED_HERE, reason="machine code is shipped for Linux on x86-64")
def test_what_is_shipped_needs_neither_a_compiler_nor_a_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("INERTIA_CACHE", str(tmp_path / "cache"))
    forget_kernels(monkeypatch)
    forbid_compiler(monkeypatch)
    forbid_llvm(monkeypatch)
    assert [corner_keys.FACES.worthwhile(count) for count in (SHIPPED_ABOVE - 1, SHIPPED_ABOVE)] == [False, True]
    assert is_one_closed_piece(LARGE)
    assert not (tmp_path / "cache").exists()


@pytest.mark.parametrize("lacking", sorted(native.LEVEL.flags))
def test_what_is_shipped_is_left_alone_by_an_older_processor(lacking: str, monkeypatch: pytest.MonkeyPatch) -> None:
    flags = "flags : " + " ".join(native.LEVEL.flags - {lacking})
    monkeypatch.setattr(native, "processor_lines", lambda: ("vendor_id : X", flags))
    forget_kernels(monkeypatch)
    assert not corner_keys.FACES.worthwhile(SHIPPED_ABOVE)


def test_every_kernel_is_shipped_as_its_source_is_now() -> None:
    names = {file.name for file in compile_kernels.files()}
    assert names == {file.name for file in native.SHIPPED.iterdir()}, "run python tests/compile_kernels.py"


@pytest.mark.skipif(not SHIPPED_HERE, reason="machine code is shipped for Linux on x86-64")
def test_all_that_is_shipped_is_linked_without_llvm(monkeypatch: pytest.MonkeyPatch) -> None:
    forbid_llvm(monkeypatch)
    for kernel in compile_kernels.kernels():
        assert Kernel(kernel.module, kernel.name, kernel.abi, fused=kernel.fused).function, kernel.name


@pytest.mark.skipif(not SHIPPED_HERE, reason="machine code is shipped for Linux on x86-64")
def test_what_is_shipped_is_what_the_source_compiles_to(monkeypatch: pytest.MonkeyPatch) -> None:
    constraints = (Path(__file__).parents[1] / "constraints.txt").read_text()
    if sys.version_info[:2] != (3, 11) or f"llvmlite=={version('llvmlite')}\n" not in constraints:
        pytest.skip("another compiler than that which wrote it")
    monkeypatch.setenv("NUMBA_CPU_NAME", "")  # restores what compiling sets
    monkeypatch.setenv("NUMBA_CPU_FEATURES", "")
    kernel = Kernel("inertia.mesh.geometry.edge_kernel", "key_vertices", "pipp")
    assert compile_kernels.machine_code(kernel) == kernel.shipped_as().read_bytes()
