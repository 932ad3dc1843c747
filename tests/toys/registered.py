"""Toys among the known mechanisms, in this process and in those that it starts."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from places import TESTS
from scene_texts import Edit, edited, written

import tol3d
from tol3d import kinds
from tol3d.study.system.mechanism import Mechanism

TOYS = TESTS / "toys"


@contextmanager
def known(*mechanisms: Mechanism) -> Iterator[None]:
    """Within it scenes may have their kinds, and processes find their modules."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(kinds, "_registered", {})
        patch.setenv("PYTHONPATH", os.pathsep.join((str(TESTS), os.environ.get("PYTHONPATH", ""))).strip(os.pathsep))
        for mechanism in mechanisms:
            tol3d.register(mechanism)
        yield


def offered(folder: Path, **paths: str) -> Path:
    """A folder for PYTHONPATH in which a package offers mechanisms, by name and import path."""
    info = folder / "toys-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: toys\nVersion: 1.0\n", encoding="utf-8")
    lines = "".join(f"{name} = {path}\n" for name, path in paths.items())
    (info / "entry_points.txt").write_text(f"[tol3d.mechanisms]\n{lines}", encoding="utf-8")
    return folder


def spring_scene(folder: Path, *changes: Edit) -> Path:
    """The scene of springs with other words, beside its file."""
    springs = TOYS / "parabola"
    (folder / "spring.csv").write_text((springs / "spring.csv").read_text("utf-8"), "utf-8")
    return written(edited((springs / "spring.yaml").read_text("utf-8"), *changes), folder)
