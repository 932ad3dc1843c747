"""Steps from a scene to its assembly: each makes new, frozen objects, and nothing of them is changed afterwards."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
from pydantic import BaseModel

from tol3d.assembly.from_scene import assembly, meant, understood
from tol3d.assembly.from_scene.features import poses_of
from tol3d.assembly.grammar.checks import pose_names
from tol3d.simulate import load

STEPS = (
    "frames_of",
    "effects_of",
    "growth",
    "gauge_shifts",
    "with_held",
    "on_gauges",
    "features_of",
    "measured_of",
    "twins_of",
    "contact_points",
    "moves_of",
    "parts_of",
)
SCENES = ("every_assembly_field", "four_pads", "slider_crank", "warm_bar")
"""With gauges, composite tolerances, locators and twins; forms that lift points; a loop with poses; temperatures."""


def copied(value: Any) -> Any:
    """A value in plain words, field by field; arrays by their bytes."""
    if is_dataclass(value) and not isinstance(value, type):
        return type(value).__name__, [(own.name, copied(getattr(value, own.name))) for own in fields(value)]
    if isinstance(value, Mapping):
        return [(copied(key), copied(own)) for key, own in value.items()]
    if isinstance(value, tuple | list):
        return [copied(own) for own in value]
    if isinstance(value, set | frozenset):
        return sorted(map(repr, value))
    if isinstance(value, np.ndarray):
        return value.shape, value.dtype.str, value.tobytes()
    return repr(value) if isinstance(value, BaseModel | slice) else value


def mutable(value: Any, path: str) -> Iterator[str]:
    """Places under a value that can be changed: lists, dictionaries, sets, and dataclasses that are not frozen."""
    if isinstance(value, list | dict | set):
        yield f"{path}: {type(value).__name__}"
    elif is_dataclass(value) and not isinstance(value, type):
        kind: Any = type(value)
        if not kind.__dataclass_params__.frozen:
            yield f"{path}: {type(value).__name__}"
        for own in fields(value):
            yield from mutable(getattr(value, own.name), f"{path}.{own.name}")
    elif isinstance(value, MappingProxyType):
        for key, own in value.items():
            yield from mutable(own, f"{path}[{key!r}]")
    elif isinstance(value, tuple):
        for k, own in enumerate(value):
            yield from mutable(own, f"{path}[{k}]")


@pytest.mark.parametrize("name", SCENES)
def test_no_step_changes_what_a_step_before_it_made(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[tuple[str, Any, Any]] = []

    def recorded(step: str, own: Callable[..., Any]) -> Callable[..., Any]:
        def call(*args: Any) -> Any:
            found = own(*args)
            found = found if is_dataclass(found) or isinstance(found, Mapping | tuple) else tuple(found)
            made.append((step, found, copied(found)))
            return found

        return call

    scene = load(name)
    for step in STEPS:
        monkeypatch.setattr(assembly, step, recorded(step, getattr(assembly, step)))
    meaning = understood(scene)
    before = copied(meaning)
    for pose in (*pose_names(scene), "")[:2]:
        meant(meaning, poses_of(scene), pose)
    assert {step for step, _, _ in made} == set(STEPS)
    assert [step for step, found, then in made if copied(found) != then] == []
    assert copied(meaning) == before


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_understood_twice_means_the_same_and_nothing_in_it_can_be_changed(name: str) -> None:
    scene = load(name)
    first, second = understood(scene), understood(scene)
    assert copied(first) == copied(second)
    assert list(mutable(first, "understood")) == []
    poses = poses_of(scene)
    for pose in (*pose_names(scene), "")[:2]:
        assert copied(meant(first, poses, pose)) == copied(meant(second, poses, pose))
