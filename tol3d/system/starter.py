"""Starter scenes: small, commented, and run as they are; the files of a mechanism, which `tol3d new` writes."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from importlib.resources import files
from importlib.resources.abc import Traversable

from tol3d.errors import InputError
from tol3d.scene.nearest import hint
from tol3d.system.faults import faults_of
from tol3d.system.mechanism import Mechanism

SCENE = ".yaml"


@dataclass(frozen=True)
class Starter:
    """A starter scene.

    Args:
        name: under which it is requested.
        mechanism: that it is of.
        text: of the scene's file; its first line is a comment that names its subject.
    """

    name: str
    mechanism: str
    text: str

    @property
    def title(self) -> str:
        """Title of the scene, without the sign of a comment."""
        return self.text.partition("\n")[0].lstrip("# ").strip()


def starters_of(mechanism: Mechanism) -> tuple[Starter, ...]:
    """The starters that a mechanism brings, by their names; none if it names no folder of them.

    Raises:
        InputError: the folder that it names is none, or has none.
        MechanismError: a mechanism of another package is at fault.
    """
    if not mechanism.starters:
        return ()
    package, _, folder = mechanism.starters.partition(":")
    with faults_of(mechanism.origin):
        found = sorted(_scenes_in(files(package).joinpath(folder)), key=lambda file: file.name)
        texts = {file.name.removesuffix(SCENE): file.read_text("utf-8") for file in found}
    if not texts:
        raise InputError(f"{mechanism.name}: expected starter scenes (*{SCENE}) at {mechanism.starters}, found none")
    return tuple(Starter(name, mechanism.name, text) for name, text in texts.items())


def starter_named(word: str, mechanisms: Iterable[Mechanism]) -> Starter:
    """The starter of a name, or that of a mechanism that has one alone; `-` and blanks are as good as `_`.

    Raises:
        InputError: there is none, or several, with the words to choose from.
    """
    asked, every = word.strip().replace("-", "_").replace(" ", "_"), tuple(mechanisms)
    starters = {own.name: starters_of(own) for own in every}
    known = [one for ones in starters.values() for one in ones]
    found = [one for one in known if asked in (one.name, f"{one.mechanism}/{one.name}")] or list(
        starters.get(asked, ())
    )
    if len(found) == 1:
        return found[0]
    if found:
        names = [one.name for one in found]
        twice = len(set(names)) < len(names)
        listed = ", ".join(f"{one.mechanism}/{one.name}" if twice else one.name for one in found)
        raise InputError(f"{word}: expected one starter scene, found {len(found)}: {listed}")
    if asked in starters:
        raise InputError(f"{word}: this mechanism brings no starter scene; its authors' documentation may have one")
    raise InputError(f"expected a kind of system, got {word!r}{hint(asked, [one.name for one in known])}")


def starter_lines(mechanisms: Iterable[Mechanism]) -> Iterator[str]:
    """A line for each starter: the word to ask for it by, and its subject; then the mechanisms without any."""
    every = tuple(mechanisms)
    starters = [one for own in every for one in starters_of(own)]
    width = max((len(one.name) for one in starters), default=0)
    yield from (f"{one.name:<{width}}  {one.title}" for one in starters)
    if bare := [own.name for own in every if not own.starters]:
        yield f"without a starter scene: {', '.join(bare)}"


def _scenes_in(folder: Traversable) -> Iterator[Traversable]:
    return (file for file in folder.iterdir() if file.name.endswith(SCENE)) if folder.is_dir() else iter(())
