"""Tolerances of a scene and their contributors: the scope of one factor, and writing it back."""

from collections.abc import Mapping

from tol3d.analyses.allocation_section import Allocation
from tol3d.analyses.response import Response
from tol3d.distributions.base import Stays
from tol3d.errors import InputError
from tol3d.scene import Scene
from tol3d.scene.edit import with_tolerances
from tol3d.scene.tolerance import ToleranceEntry
from tol3d.system.other_laws import naturally_stays


def groups_of(scene: Scene, response: Response) -> dict[str, tuple[str, ...]]:
    """Contributors by the name of their tolerance: one, or one for each feature that it is of."""
    found: dict[str, list[str]] = {}
    entries = sorted(map(str, scene.tolerances), key=len, reverse=True)
    for own in response.contributors:
        name = own.name
        entry = name if name in scene.tolerances else next((e for e in entries if name.startswith(f"{e} ")), name)
        found.setdefault(entry, []).append(name)
    return {name: tuple(own) for name, own in found.items()}


def allocated_scene(scene: Scene, response: Response, found: Allocation, stays: Mapping[str, Stays]) -> Scene:
    """The scene with allocated tolerances, in its text too.

    Raises:
        InputError: one whose width the scene states in no numbers.
    """
    groups = groups_of(scene, response)
    changed: dict[str, ToleranceEntry] = {}
    for name, own in found.tolerances.items():
        if own.factor == 1.0:
            continue
        if name not in scene.tolerances:
            raise InputError(f"{name}: expected a tolerance of the scene, got what a move says; --freeze it")
        at = stays.get(name) or naturally_stays(response.drawn_by(groups[name][0]))
        try:
            changed[name] = scene.tolerances[name].scaled(own.factor, at, scene.files)
        except InputError as error:
            raise InputError(f"{name}: {error}; --freeze it, or leave --out") from None
    return with_tolerances(scene, changed)
