"""Tolerances of a scene and their contributors: the scope of one factor, and writing it back."""

from collections.abc import Mapping

from tol3d.analyses.allocation_section import Allocation
from tol3d.analyses.response import Response
from tol3d.distributions.base import Stays
from tol3d.errors import InputError
from tol3d.scene import Scene
from tol3d.scene.edit import with_tolerances
from tol3d.scene.tolerance import ToleranceEntry
from tol3d.study.lines import Line
from tol3d.system.other_laws import naturally_stays


def groups_of(response: Response) -> Mapping[str, tuple[str, ...]]:
    """Contributors by the name of their tolerance: one, or one for each feature and part that it is of."""
    return {name: own.contributors for name, own in _tolerances(response).items()} or response.lines


def _tolerances(response: Response) -> dict[str, Line]:
    """The lines of a scene, those of one tolerance together: that of a pattern, and that of its motion."""
    found: dict[tuple[str, ...], list[Line]] = {}
    for own in response.simulation.lines:
        found.setdefault(own.entries or (own.name,), []).append(own)
    return {
        (name := min((own.name for own in lines), key=len)): Line(
            name, tuple(each for own in lines for each in own.contributors), lines[0].entries
        )
        for lines in found.values()
    }


def allocated_scene(scene: Scene, response: Response, found: Allocation, stays: Mapping[str, Stays]) -> Scene:
    """The scene with allocated tolerances, in its text too.

    Raises:
        InputError: one whose width the scene states in no numbers.
    """
    tolerances = _tolerances(response)
    changed: dict[str, ToleranceEntry] = {}
    for name, own in found.tolerances.items():
        if own.factor == 1.0:
            continue
        if not tolerances[name].entries:
            raise InputError(f"{name}: expected a tolerance of the scene, got what a move says; --freeze it")
        at = stays.get(name) or naturally_stays(response.drawn_by(tolerances[name].contributors[0]))
        for entry in tolerances[name].entries:
            try:
                changed[entry] = scene.tolerances[entry].scaled(own.factor, at, scene.files)
            except InputError as error:
                raise InputError(f"{entry}: {error}; --freeze it, or leave --out") from None
    return with_tolerances(scene, changed)
