"""From what a scene writes of a mesh to its pair of gears."""

from functools import singledispatch

from tol3d.gearing.grammar.moves import GearMeshSpec
from tol3d.gears import Gear, GearPair
from tol3d.scene import Scene
from tol3d.units import Quantity


@singledispatch
def pair_of(move: GearMeshSpec, name: str, scene: Scene) -> GearPair:
    """The pair of a move.

    Args:
        move: the move.
        name: its name.
        scene: the scene that it stands in.

    Raises:
        SceneError: gears that cannot be made or run together, with their numbers and place.
    """
    raise TypeError(f"pairs/ has no function for {type(move).__name__}")


@singledispatch
def undercut_warning(gear: Gear) -> str:
    """What a generating rack would take off a flank, outside the flank in use; or nothing."""
    return ""


@singledispatch
def assembly_warning(pair: GearPair) -> str:
    """How the gears of a pair cannot be put together though they run together; or nothing."""
    return ""


def internal(quantity: Quantity | None, otherwise: float = 0.0) -> float:
    """A quantity in mm, rad, K or 1/K; `otherwise` where none was given."""
    return otherwise if quantity is None else quantity.internal
