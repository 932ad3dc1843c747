"""The scenes that tol3d brings along, by the mechanism that understands them."""

from functools import cache

from places import SCENES

from tol3d import load_scene
from tol3d.kinds import all_kinds


@cache
def shipped(mechanism: str) -> tuple[str, ...]:
    """Names of the scenes that a mechanism understands."""
    paths = sorted(SCENES.glob("*.yaml"))
    return tuple(path.stem for path in paths if all_kinds().vocabulary_of(load_scene(path)).name == mechanism)
