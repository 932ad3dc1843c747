"""Shared ground: the paper's spur pair as a model, engines on the strips of real solids, the command line."""

import gc
import os
import sys
from collections.abc import Generator, Iterator
from typing import Any

import bytecode  # noqa: F401, first of all
import hypothesis
import pytest
from fixtures import Command, EngineOf, strips_of
from places import SPUR_PAIR
from sets import MANY, DearestFirst, compile_kernels, dearest_first, sort_into_sets
from toys.parabola import PARABOLA
from toys.registered import known

from tol3d import cli, load_scene
from tol3d.gearing.engines.fcl import FclEngine
from tol3d.gearing.model import Model, model_from_scene

# shared machines stall for longer than any deadline and examples are the same;
# HYPOTHESIS_PROFILE=search tries others, HYPOTHESIS_PROFILE=found makes none smaller that fails
hypothesis.settings.register_profile("tol3d", deadline=None, derandomize=True)
hypothesis.settings.register_profile("search", deadline=None)
FOUND = (hypothesis.Phase.explicit, hypothesis.Phase.generate)
hypothesis.settings.register_profile("found", deadline=None, derandomize=True, phases=FOUND)
hypothesis.settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "tol3d"))

# what pyproject.toml makes an error here, numpy's warnings, is one in the processes that tests start too
os.environ.setdefault("PYTHONWARNINGS", "error::RuntimeWarning")


def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> DearestFirst | None:
    """Share whole files between processes (--dist loadfile, as set in pyproject.toml)."""
    return DearestFirst(config, log) if config.getoption("dist") == "loadfile" else None


@pytest.hookimpl(tryfirst=True)  # before pytest selects by marks
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Sort tests into default, slow and nightly ones; where processes share them, start with the dearest files."""
    sort_into_sets(items)
    if hasattr(config, "workerinput"):
        items[:] = dearest_first(items)


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, Any, Any]:
    """Collect without looking for garbage: tests stay until the end, going through them again and again takes long."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()  # nor is what is there by now looked through later
        gc.enable()


def pytest_collection_finish(session: pytest.Session) -> None:
    """Compile kernels before many tests, each process some."""
    if len(session.items) >= MANY and hasattr(session.config, "workerinput"):
        worker = session.config.workerinput
        compile_kernels(int(worker["workerid"].removeprefix("gw")), worker["workercount"])


@pytest.fixture(scope="session")
def paper_model() -> Model:
    """Tables 1 and 2 of the paper: thicknesses, eccentricities, run-out, clearance and centre distance all act."""
    return model_from_scene(load_scene(SPUR_PAIR))


@pytest.fixture(scope="session")
def engine_of() -> EngineOf:
    """FCL on the measuring strips of a model's gears, `steps` on each flank (the study's own, if not said)."""

    def make(model: Model, steps: int | None = None) -> FclEngine:
        steps = steps or model.profile_steps
        return FclEngine(model, {part.name: strips_of(part.gear, steps) for part in model.gears})

    return make


@pytest.fixture(scope="module")
def springs() -> Iterator[None]:
    """The mechanism of springs is known."""
    with known(PARABOLA):
        yield


@pytest.fixture
def tol3d(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Command:
    """Runs `tol3d ARGUMENTS` in this process: exit code, stdout, stderr."""

    def command(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["tol3d", *arguments])
        capfd.readouterr()
        try:
            cli.main()
            code = 0
        except SystemExit as stop:
            code = int(stop.code or 0)
        out, err = capfd.readouterr()
        return code, out, err

    return command
