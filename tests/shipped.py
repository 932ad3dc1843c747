"""The scenes that tol3d brings along, by mechanism; a train with links of another one is that one's."""

from functools import cache

from places import SCENES

from tol3d.kinds import all_kinds
from tol3d.scene import read_scene


@cache
def _mechanisms() -> dict[str, str]:
    """Mechanism of each scene."""
    return {
        path.stem: _last([own.name for own in all_kinds().vocabularies_of(read_scene(path, all_kinds(), settle=False))])
        for path in sorted(SCENES.glob("*.yaml"))
    }


def _last(names: list[str]) -> str:
    """A machine is one, whatever turns its joints."""
    return "machine" if "machine" in names else names[-1]


def shipped(mechanism: str) -> tuple[str, ...]:
    """Names of the scenes that have kinds of a mechanism, and none of one that is registered after it.

    Raises:
        LookupError: there are none, so that a test of all of them would test nothing.
    """
    found = tuple(scene for scene, its in _mechanisms().items() if its == mechanism)
    if not found:
        raise LookupError(f"no scene of {mechanism!r}; mechanisms are {sorted(set(_mechanisms().values()))}")
    return found
