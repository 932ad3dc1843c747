"""Types of the fixtures in conftest.py, and strips that tests build once, wherever they stand."""

from collections.abc import Callable
from functools import cache
from typing import Protocol

from tol3d.cad.solids import FlankStrips, measuring_strips
from tol3d.gearing.engines.fcl import FclEngine
from tol3d.gearing.model import Model
from tol3d.gears import Gear

Command = Callable[..., tuple[int, str, str]]
"""`tol3d ARGUMENTS` in this process: exit code, stdout, stderr."""


class EngineOf(Protocol):
    """FCL on the measuring strips of a model's gears, `steps` on each flank; None takes the study's own."""

    def __call__(self, model: Model, steps: int | None = None) -> FclEngine: ...


@cache
def strips_of(gear: Gear, steps: int) -> FlankStrips:
    """Measuring strips of a gear's solid, `steps` on each flank."""
    return measuring_strips(gear, steps)
