"""Checked Scene from a scene's file."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

from tol3d.errors import SceneError
from tol3d.files import Files, read_file
from tol3d.import_path import named
from tol3d.scene.bundled import scene_path
from tol3d.scene.grammar import Grammar, Kinds
from tol3d.scene.include import Includes
from tol3d.scene.place import Node, Origin, Places, plain
from tol3d.scene.references import bad_names, loose_ends, refuse, unreadable_files
from tol3d.scene.schema import SECTIONS, Scene
from tol3d.scene.text import read_scene_text, scene_text


class Settle(Protocol):
    """Finds the numbers that a scene leaves to the solids of its parts."""

    def __call__(self, scene: Scene, *, run_builders: bool, known: Files | None) -> tuple[Scene, Files]:
        """The scene with all numbers, and the findings as files that a run keeps.

        Args:
            scene: checked field by field, and for names.
            run_builders: whether programs that the scene names may be run.
            known: earlier findings among a run's files; then nothing is built.

        Raises:
            SceneError: a solid cannot be built, or contradicts the scene; one or several messages.
        """
        ...


def is_settled(scene: Scene) -> bool:
    """True if all of it is known as it stands."""
    return not any(part.has_solid for part in scene.parts.values())


def settled(scene: Scene, *, run_builders: bool, known: Files | None) -> Scene:
    """The scene with all numbers, the findings among its files.

    Raises:
        SceneError: a solid cannot be built, or contradicts the scene.
    """
    origin = scene.origin
    for vocabulary in scene.grammar.vocabularies_of(scene):
        if vocabulary.settle:
            settle: Settle = named(vocabulary.settle)
            scene, found = settle(scene, run_builders=run_builders, known=known)
            origin = replace(origin, files={**origin.files, **found})
    return scene.read_from(origin)


Examine = Callable[[Scene], None]


def read_scene(
    path: Path | str,
    kinds: Kinds,
    *,
    trust_parts: bool = False,
    run_builders: bool = False,
    files: Files | None = None,
    settle: bool = True,
    examine: Examine | None = None,
) -> Scene:
    """Read a scene and the files that it names.

    Where it picks features from solids, these are built, unless that was done before; programs that it names are run
    only where that is allowed.

    Args:
        path: the YAML file, or the name of a bundled scene.
        kinds: allowed ones; a Grammar, or kinds that are loaded as it names them.
        trust_parts: whether the scene may name files outside its own folder.
        run_builders: whether programs that it names as builders of its parts may be run.
        files: the contents of the files that it names, if known; then none is read, and nothing built.
        settle: False leaves open the numbers that solids decide, for lists of scenes.
        examine: is shown the scene with its files before anything is built, or any program run; it may raise.

    Raises:
        SceneError: one or several messages `file:line: place: what was expected, what came`.
    """
    source = scene_path(path)
    top, origin = read_scene_text(source)
    return _read(top, origin, kinds, _Asked(trust_parts, run_builders, files, settle, examine))


def scene_of_text(
    source: Path,
    content: bytes,
    kinds: Kinds,
    *,
    trust_parts: bool = False,
    run_builders: bool = False,
    files: Files | None = None,
) -> Scene:
    """The same of a text that lies in no file yet.

    Args:
        source: its assumed path, for messages and relative names.
        content: the text.
        kinds, trust_parts, run_builders, files: see read_scene.

    Raises:
        SceneError: see read_scene.
    """
    top, origin = scene_text(source, content)
    return _read(top, origin, kinds, _Asked(trust_parts, run_builders, files))


@dataclass(frozen=True)
class _Asked:
    """Options of reading a scene; see read_scene."""

    trust_parts: bool
    run_builders: bool
    files: Files | None
    settle: bool = True
    examine: Examine | None = None


def _read(top: Node, origin: Origin, kinds: Kinds, asked: _Asked) -> Scene:
    source, files = origin.source, asked.files
    includes = Includes(source, kinds, files)
    top = includes.expanded(top, origin)
    origin = replace(origin, places=Places(top), files=includes.files, included=tuple(includes.files))

    def checked(grammar: Grammar) -> Scene:
        data = plain(top)
        found = _with_files(
            grammar.scene.model_validate(data, context=origin), origin, files, trust_parts=asked.trust_parts
        )
        if not (added := grammar.general(found)):
            return found
        whole = {**data, "tolerances": {**(data.get("tolerances") or {}), **added}}
        named = replace(found.origin, general=tuple(added))
        return _with_files(
            grammar.scene.model_validate(whole, context=named), named, found.files, trust_parts=asked.trust_parts
        )

    grammar = kinds.saying(_words(top))
    try:
        scene = checked(grammar)
        if not grammar.understands(scene):
            scene = checked(kinds.whole())  # whose message names what may join its kinds
    except SceneError:
        if grammar is kinds.whole():
            raise
        scene = checked(kinds.whole())  # its message names the nearest of all kinds
    if asked.examine is not None:
        asked.examine(scene)
    return _settled(scene, files, run_builders=asked.run_builders) if asked.settle else scene


def _words(top: Node) -> frozenset[str]:
    """The kinds of its entries, as far as they are words."""
    kinds = (entry.held_value("kind") for section in SECTIONS for _, entry in top.held(section).values())
    return frozenset(kind for kind in kinds if isinstance(kind, str))


def scene_from_python(scene: Scene, *, trust_parts: bool = False, run_builders: bool = False) -> Scene:
    """A scene that was made in Python, checked as one from a file is; its text is JSON, which is YAML too.

    Raises:
        SceneError: names or files that cannot be found; relative ones start at the working folder.
    """
    text = scene.model_dump_json(indent=1, exclude_unset=True, by_alias=True) + "\n"
    source = scene.source if scene.source != Origin().source else Path("scene.yaml")
    if scene.general is not None:
        whole: Kinds = scene.grammar
        return scene_of_text(source, text.encode(), whole, trust_parts=trust_parts, run_builders=run_builders)
    scene = _with_files(scene, Origin(source, text), None, trust_parts=trust_parts)
    return _settled(scene, None, run_builders=run_builders)


def _with_files(scene: Scene, origin: Origin, known: Files | None, *, trust_parts: bool) -> Scene:
    scene = scene.read_from(origin)
    problems = loose_ends(scene) if is_settled(scene) else bad_names(scene)
    refuse(scene, problems if known is not None else [*problems, *unreadable_files(scene, trust_parts)])
    files = known
    if files is None:
        unread = (name for name in scene.file_names if name not in origin.included)
        files = {**origin.files, **{name: read_file(scene.folder / name) for name in unread}}
    return scene.read_from(replace(origin, files=files))


def _settled(scene: Scene, known: Files | None, *, run_builders: bool) -> Scene:
    if not is_settled(scene):
        scene = settled(scene, run_builders=run_builders, known=known)
        refuse(scene, loose_ends(scene))
    return scene
