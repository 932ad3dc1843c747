"""Parts of kernels: what numba compiles of them, and what Python does that calls one."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tol3d.numerics import programme
from tol3d.numerics.cache_folder import FOLDER_VARIABLE
from tol3d.numerics.compiled import PLAINLY, Kernel, kernel, nested, part

each_kind = pytest.mark.parametrize("kind", [part, nested])


def weighed(kind: Callable[..., Any]) -> tuple[Any, Any, Any]:
    """A part, a part that has it in it, and a kernel of both."""

    def inner(x: float, y: float) -> float:
        return 3.0 * x + y

    own: Any = kind(inner)

    def outer(pair: tuple[float, float], x: float) -> Any:
        return own(pair[0], x) - own(x, pair[1])

    mine: Any = kind(outer)

    def written(found: Any) -> None:
        for i in range(found.shape[0]):
            found[i] = mine((found[i], 2.0), 5.0)

    return own, mine, kernel(arrays="float64[::1]")(written)


@each_kind
def test_a_kernel_does_what_its_parts_say_which_have_no_machine_code_of_their_own(
    kind: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(FOLDER_VARIABLE, str(tmp_path / "cache"))
    own, mine, made = weighed(kind)
    found = np.array([0.0, 1.0, 7.0])
    made(found)
    assert found.tolist() == [-12.0, -9.0, 9.0]  # 3 a + 5 - (3 x 5 + 2)
    for each in (own, mine):
        (compiled,) = each.overloads.values()
        names = [function.name for function in compiled.library.get_defined_functions()]
        assert compiled.fndesc.llvm_func_name in names
        assert compiled.fndesc.llvm_cpython_wrapper_name not in names
        assert compiled.fndesc.llvm_cfunc_wrapper_name not in names
        assert not compiled.library.codegen._engine.is_symbol_defined(compiled.fndesc.llvm_func_name)


@each_kind
def test_python_that_calls_a_part_runs_it_as_python(kind: Callable[..., Any]) -> None:
    own, mine, _ = weighed(kind)
    assert own(2, 1) == 7.0
    assert mine((0.0, 2.0), 5.0) == -12.0
    assert not own.overloads
    assert not mine.overloads


@each_kind
def test_numba_alone_compiles_parts_too(
    kind: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """For the day on which numba's own methods, which compiling parts changes, are others."""
    monkeypatch.setenv(FOLDER_VARIABLE, str(tmp_path / "cache"))
    monkeypatch.setenv(PLAINLY, "1")
    own, _, made = weighed(kind)
    found = np.array([0.0, 1.0, 7.0])
    made(found)
    assert found.tolist() == [-12.0, -9.0, 9.0]
    (compiled,) = own.overloads.values()
    assert compiled.fndesc.llvm_cpython_wrapper_name in [
        function.name for function in compiled.library.get_defined_functions()
    ]


def test_kernels_of_numba_alone_are_kept_under_names_of_their_own(monkeypatch: pytest.MonkeyPatch) -> None:
    usual = Kernel(programme.ranges._function, (), "float64[::1]").name
    monkeypatch.setenv(PLAINLY, "1")
    assert usual != Kernel(programme.ranges._function, (), "float64[::1]").name
