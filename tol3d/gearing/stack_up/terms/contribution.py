"""What the effects of contributors do in a mesh by the stack-up; each file of this folder registers one effect."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from tol3d.gearing.model import Contributor, Effect
from tol3d.gearing.stack_up.nominal_mesh import NominalMesh
from tol3d.gearing.stack_up.term import Term
from tol3d.gears import GearPair

E = TypeVar("E", bound=Effect)
P = TypeVar("P", bound=GearPair)


@dataclass(frozen=True)
class Contribution:
    """What one effect does in one mesh, to first order; then what a stack-up leaves out of that, for its bounds.

    Args:
        opening: change of the normal backlash [mm].
        aside: shift [mm] of the middle of the driven gear's play, along the flanks' normals; positive turns the driven
            gear in the positive sense about its z.
        strains: of parts that grow [1/K], by name.
        by_shifts, by_turns: of the opening, what is alike on the whole face, and what grows with the distance from the
            apex of a cone.
        aside_by_turns: a shift of that middle which `aside` lacks, by turns about a pivot that is not the apex.
        along_line: shift of the driver's apex less the driven gear's, along the pitch line [mm].
        claimed: of the opening, what a source claims and the geometry does not show.
    """

    opening: Term | None = None
    aside: Term | None = None
    strains: tuple[tuple[str, Term], ...] = ()
    by_shifts: Term | None = None
    by_turns: Term | None = None
    aside_by_turns: Term | None = None
    along_line: Term | None = None
    claimed: Term | None = None


NOTHING = Contribution()

_KNOWN: dict[tuple[type[Effect], type | None], Callable[[Any, Any, Contributor], Contribution]] = {}


def contributes(
    effect: type[E], pair: type[P] | None = None
) -> Callable[[Callable[[E, NominalMesh[P], Contributor], Contribution]], object]:
    """Register what an effect does in meshes of one kind of pair, or in those of every kind that has none of its own.

    The registered function is called with the effect, the mesh and the contributor.
    """

    def register(function: Callable[[E, NominalMesh[P], Contributor], Contribution]) -> object:
        _KNOWN[effect, pair] = function
        return function

    return register


def contribution(effect: Effect, mesh: NominalMesh[GearPair], contributor: Contributor) -> Contribution:
    """What an effect does in a mesh.

    Raises:
        TypeError: nothing is registered for it.
    """
    for pair in (*type(mesh.pair).__mro__, None):
        if function := _KNOWN.get((type(effect), pair)):
            return function(effect, mesh, contributor)
    raise TypeError(f"stack_up/terms/ has no file for the effect {type(effect).__name__}")
