"""A mechanism: kinds of entry that belong together, and the system that they mean."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from tol3d.errors import InputError
from tol3d.import_path import named
from tol3d.scene import Scene, Vocabulary
from tol3d.system.faults import Origin, faults_of
from tol3d.system.system import System


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
            `tol3d.system.starter`; "" for none.
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
    extending = (each.requires for each in others if isinstance(each, Mechanism))
    entries = (entry.requires for entry in scene.entries().values())
    return tuple(dict.fromkeys(name for names in (own.requires, *extending, *entries) for name in names))
