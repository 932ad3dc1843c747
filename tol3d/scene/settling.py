"""Scenes that leave numbers to solids, such as where a face lies: they are looked up when the scene is read."""

from dataclasses import replace
from typing import Protocol

from tol3d.files import Files
from tol3d.import_path import named
from tol3d.scene.schema import Scene


class Settle(Protocol):
    """Finds out what a scene leaves to the solids of its parts."""

    def __call__(self, scene: Scene, *, run_builders: bool, known: Files | None) -> tuple[Scene, Files]:
        """The scene with all numbers, and what was found as files that a run keeps.

        Args:
            scene: checked field by field, and for names.
            run_builders: whether programs that the scene names may be run.
            known: what was found before, among a run's files; nothing is built then.

        Raises:
            SceneError: a solid cannot be built, or is not what the scene says; one or several messages.
        """
        ...


def is_settled(scene: Scene) -> bool:
    """Whether all of it is known as it stands."""
    return not any(part.has_solid for part in scene.parts.values())


def settled(scene: Scene, *, run_builders: bool, known: Files | None) -> Scene:
    """The scene with all numbers, what was found among its files.

    Raises:
        SceneError: a solid cannot be built, or is not what the scene says.
    """
    origin = scene.origin
    for vocabulary in scene.grammar.vocabularies_of(scene):
        if vocabulary.settle:
            settle: Settle = named(vocabulary.settle)
            scene, found = settle(scene, run_builders=run_builders, known=known)
            origin = replace(origin, files={**origin.files, **found})
    return scene.read_from(origin)
