"""Runs of the scenes with the trials of their expected numbers."""

from collections.abc import Callable
from functools import cache

import pytest
from expected import expected
from places import SCENES

from tol3d import Overrides, Run, run_scene


@pytest.fixture(scope="session")
def run_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Run]:
    """A run of a scene with the trials of its file, on both methods."""

    @cache
    def run(scene: str) -> Run:
        trials = Overrides(trials=expected(scene)["trials"])
        return run_scene(SCENES / f"{scene}.yaml", overrides=trials, out=tmp_path_factory.mktemp("runs") / scene)

    return run
