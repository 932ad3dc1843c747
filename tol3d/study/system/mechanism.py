"""A mechanism: kinds of entry that belong together, and the system that they mean.

Starter scenes: small, commented, and run as they are; the files of a mechanism, which `tol3d new` writes.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Any

from tol3d.errors import InputError
from tol3d.import_path import named
from tol3d.scene import Scene, Vocabulary
from tol3d.scene.nearest import hint
from tol3d.study.system.faults import Origin, faults_of
from tol3d.study.system.system import System


@dataclass(frozen=True)
class Mechanism(Vocabulary):
    """Mechanism that tol3d can simulate: its words in scenes, and the import paths of its code.

    Code is named by import paths `package.module:name`, so that opening a scene loads no geometry and no compiler.

    Args:
        system: path of the function that makes the system of a scene; "" where it only adds kinds to the scenes
            of the mechanisms that it `extends`.
        links: path of the function that makes the additions of a scene's moves to the systems of those; see `brought`.
        summary: path of the classes of its measures and sections in a run's summary.
        presenter: import path of the module whose PRESENTER shows it, see `tol3d.report.presenter`; "" for none.
        starters: `package:folder` of its starter scenes, YAML files that `tol3d new` writes, see
            `tol3d.study.system.mechanism`; "" for none.
        commands: import paths of functions with typer's annotations, which the command line has under their names, see
            `tol3d.cli.commands`; a mechanism of commands alone has no kinds.
        requires: distributions whose versions decide its results beside those that every study needs; they are part
            of a run's fingerprint.
    """

    system: str = ""
    links: str = ""
    summary: str = ""
    presenter: str = ""
    starters: str = ""
    commands: tuple[str, ...] = ()
    requires: tuple[str, ...] = ()

    @property
    def origin(self) -> Origin:
        """Origin of the mechanism, for messages and summaries."""
        path = next((own for own in (self.system, self.links, *self.commands) if own), "")
        return Origin(self.name, path.partition(":")[0])

    def system_of(self, scene: Scene) -> System:
        """System of a scene.

        Raises:
            SceneError: it cannot be simulated; with the place and the remedy.
        """
        system: System = named(self.system)(scene)
        return system


def brought(scene: Scene) -> Iterator[Any]:
    """Additions to a scene's system by the mechanisms whose kinds it has, one after the other.

    Their type is defined by the mechanism that they extend.

    Raises:
        SceneError: something that cannot be built, with its place.
        MechanismError: a mechanism of another package is at fault.
    """
    for own in _bringing(scene):
        with faults_of(own.origin):
            yield named(own.links)(scene)


def _bringing(scene: Scene) -> Iterator[Mechanism]:
    """The mechanisms whose kinds a scene has and that add to the system of another one."""
    return (own for own in scene.grammar.vocabularies_of(scene) if isinstance(own, Mechanism) and own.links)


def mechanism_of(scene: Scene) -> Mechanism:
    """The mechanism that a scene is of.

    Raises:
        SceneError: it has kinds of several that do not know each other.
        InputError: its kinds are those of a bare vocabulary.
    """
    found = scene.grammar.vocabulary_of(scene)
    if not isinstance(found, Mechanism):
        raise InputError(f"{found.name}: expected a Mechanism, got a vocabulary, of which nothing can be simulated")
    if not found.system:
        others = " or ".join(found.extends) or "another mechanism"
        raise InputError(f"{scene.scene}: kinds of {found.name} stand beside those of {others}, and there are none")
    return found


def origin_of(scene: Scene) -> Origin:
    """Mechanism of a scene, and the others that add to its system; raises as `mechanism_of`."""
    own = mechanism_of(scene)
    return replace(own.origin, beside=tuple(each.name for each in _bringing(scene) if each.name != own.name))


def requires_of(scene: Scene) -> tuple[str, ...]:
    """The packages whose versions decide its results: of its mechanism, of its extensions, of laws and entries."""
    own = mechanism_of(scene)
    hosts = {own.name, *own.includes}
    used = (each for each in scene.grammar.vocabularies_of(scene) if hosts & set(each.extends))
    others = (*used, *scene.grammar.lawgivers_of(scene))
    extending = (other.requires for other in others if isinstance(other, Mechanism))
    entries = (entry.requires for entry in scene.entries().values())
    return tuple(dict.fromkeys(name for names in (own.requires, *extending, *entries) for name in names))


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
    width = max((len(starter.name) for starter in starters), default=0)
    yield from (f"{starter.name:<{width}}  {starter.title}" for starter in starters)
    if bare := [own.name for own in every if not own.starters]:
        yield f"without a starter scene: {', '.join(bare)}"


def _scenes_in(folder: Traversable) -> Iterator[Traversable]:
    return (file for file in folder.iterdir() if file.name.endswith(SCENE)) if folder.is_dir() else iter(())
