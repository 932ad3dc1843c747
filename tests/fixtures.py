"""Types of the fixtures in conftest.py, for tests wherever they stand."""

from collections.abc import Callable
from typing import Protocol

from tol3d.gearing.engines.fcl import FclEngine
from tol3d.gearing.model import Model

Command = Callable[..., tuple[int, str, str]]
"""`tol3d ARGUMENTS` in this process: exit code, stdout, stderr."""


class EngineOf(Protocol):
    """FCL on the measuring strips of a model's gears, `steps` on each flank; None takes the study's own."""

    def __call__(self, model: Model, steps: int | None = None) -> FclEngine: ...
