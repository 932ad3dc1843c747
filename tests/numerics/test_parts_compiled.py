"""Kernels and parts that the first check of a scene compiles: ceilings, counted without compiling and without a clock.

A part costs 0.05 to 0.8 s of processor time, which a user waits for once.
"""

from collections.abc import Callable
from types import CodeType
from typing import Any

import pytest
from places import SCENES

from tol3d.numerics.compiled import Kernel
from tol3d.report.check import check_report
from tol3d.simulate import Overrides, load, simulation_of
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.simulation import Simulation

CEILINGS = {"hole_and_slot": (1, 24), "cover_on_base": (1, 7), "door": (1, 7), "bolted_cover": (1, 7)}


def parts_of(function: Any, known: frozenset[Any] = frozenset()) -> frozenset[Any]:
    """Parts that a function calls by their names, and those that they call, besides those known."""
    python = getattr(function, "py_func", function)
    for name in names_in(python.__code__):
        called = python.__globals__.get(name)
        if hasattr(called, "py_func") and called not in known:
            known = parts_of(called, known | {called})
    return known


def names_in(code: CodeType) -> set[str]:
    """Names that code looks up, in loops and comprehensions of its own too."""
    return {*code.co_names}.union(*(names_in(own) for own in code.co_consts if isinstance(own, CodeType)))


def answered(simulation: Simulation) -> None:
    """Ten trials by both methods, of all measures: a check needs no other kernels, and takes longer."""
    system = simulation.system
    for method in ("analytic", "exact"):
        system.method(method, system.materials(method)).answers(drawn(simulation, 0, 10), system.measures)


@pytest.mark.parametrize("needs", [answered, pytest.param(check_report, marks=pytest.mark.slow)])
@pytest.mark.parametrize("scene", CEILINGS)
def test_a_check_compiles_no_more_parts_than_it_did(
    scene: str, needs: Callable[[Simulation], Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    called, run = set[Kernel](), Kernel.__call__

    def recorded(kernel: Kernel, *arguments: Any) -> None:
        called.add(kernel)
        run(kernel, *arguments)

    monkeypatch.setattr(Kernel, "__call__", recorded)
    simulation = simulation_of(load(SCENES / f"{scene}.yaml"), Overrides(trials=10))
    needs(simulation)
    parts = frozenset[Any]().union(*(parts_of(own._function) for own in called))
    kernels, ceiling = CEILINGS[scene]
    assert 0 < len(called) <= kernels, sorted(own._function.__name__ for own in called)
    assert 0 < len(parts) <= ceiling, sorted(own.py_func.__name__ for own in parts)


def test_parts_are_counted_once_at_any_depth() -> None:
    """As functions that call each other."""

    def marked(function: Any) -> Any:
        function.py_func = function
        return function

    space: dict[str, Any] = {}
    exec("def low(): pass\ndef mid(): return [low() for _ in ()]\ndef top(): mid(), low(), print", space)
    low, mid = (marked(space[name]) for name in ("low", "mid"))
    assert parts_of(space["top"]) == {low, mid}
    assert parts_of(low) == frozenset()
