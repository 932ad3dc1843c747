"""A scene with some of its values changed, as `Scene.with_` makes it: checked anew, with a text that loads again.

A field is named as messages name it: `tolerances.centre distance.distribution.upper`, `parts.plate.size[0]`. What the
scene's file says otherwise stays as it was written. An entry of an included file is left out there, and written into
the scene.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

from tol3d.errors import InputError
from tol3d.scene.edit import without
from tol3d.scene.include import Includes
from tol3d.scene.including import INCLUDE
from tol3d.scene.load import scene_of_text
from tol3d.scene.nearest import hint
from tol3d.scene.place import KeyPath, path_text, plain
from tol3d.scene.schema import SECTIONS, Scene
from tol3d.scene.splice import INDENT, flow_text, spliced, written_values
from tol3d.scene.text import scene_text
from tol3d.statistics.distributions.drawn import DEFAULT_LAW
from tol3d.units import BARE_NUMBER, NUMBER_UNIT, Quantity

TOP: Final = ("scene", "description", DEFAULT_LAW, "general", "standard", "envelope", *SECTIONS, "study", "published")
INDEX: Final = re.compile(r"(.*)\[(\d+)\]")


def varied(scene: Scene, changes: Mapping[str, Any], *, trust_parts: bool = False, run_builders: bool = False) -> Scene:
    """The scene with other values; see `Scene.with_`."""
    text = scene.text or dumped(scene)
    before = _values(scene, text)
    paths = {field: field_path(before, field) for field in changes}
    for field, path in paths.items():
        text = spliced(_taken_over(text, before, path), path, _plain(changes[field]))
    return scene_of_text(
        scene.source,
        text.encode(),
        scene.grammar,
        trust_parts=trust_parts,
        run_builders=run_builders,
        files=_known(scene) if _keeps_solids(scene, paths.values(), changes.values()) else None,
    )


def known_path(scene: Scene, field: str) -> KeyPath:
    """The keys of a field of a scene.

    Raises:
        InputError: see field_path.
    """
    return field_path(_values(scene, scene.text or dumped(scene)), field)


def numbers_of(scene: Scene) -> Mapping[str, str]:
    """Numbers of a scene's parts, tolerances, moves and measures, as they are written, by their fields."""
    values = _values(scene, scene.text or dumped(scene))
    return {path_text(path): str(own) for section in SECTIONS for path, own in _leaves(values.get(section), (section,))}


def _leaves(value: Any, path: KeyPath) -> Iterator[tuple[KeyPath, Any]]:
    """Numbers inside a value, with their keys."""
    items = value.items() if isinstance(value, Mapping) else enumerate(value) if isinstance(value, list) else ()
    for key, own in items:
        yield from _leaves(own, (*path, key))
    if _is_number(value) and not isinstance(value, bool):
        yield path, value


def _values(scene: Scene, text: str) -> Any:
    """Its plain values, with those of included files."""
    top, origin = scene_text(scene.source, text.encode())
    return plain(Includes(scene.source, scene.grammar, _known(scene)).expanded(top, origin))


def dumped(scene: Scene) -> str:
    """A text that loads as the scene: its own, or the values given in Python, as YAML."""
    if scene.text:
        return scene.text
    data = scene.model_dump(mode="json", exclude_unset=True, by_alias=True)
    lines = []
    for key, value in data.items():
        is_section = isinstance(value, dict) and value and key in (*SECTIONS, "published")
        lines.append(f"{key}:" if is_section else f"{key}: {flow_text(value)}")
        entries = value.items() if is_section else ()
        lines += [f"{' ' * INDENT}{flow_text(name)}: {flow_text(own)}" for name, own in entries]
    return "\n".join([*lines, ""])


def field_path(data: Mapping[str, Any], field: str) -> KeyPath:
    """The keys of a field that is named as messages name it.

    Args:
        data: the scene's plain values, with those of included files.
        field: its name.

    Raises:
        InputError: no such section or entry, or a list's item that is not there.
    """
    if not field:
        raise InputError("expected the name of a field, such as tolerances.NAME.distribution.upper, got nothing")
    path: list[str | int] = []
    here: Any = data
    rest = field
    while rest:
        key, rest = _first(here, rest)
        index = INDEX.fullmatch(key) if not (isinstance(here, Mapping) and key in here) else None
        for part in _parts(key, index):
            _refuse_unknown(data, here, tuple(path), part, field)
            path.append(part)
            here = _inside(here, part)
    return tuple(path)


def _first(here: Any, rest: str) -> tuple[str, str]:
    """The first key of a dotted name, the longest that is known there, and the rest."""
    known = [key for key in here if rest == key or rest.startswith((f"{key}.", f"{key}["))] if _is_map(here) else []
    if known:
        key = max(known, key=len)
        return (key, rest[len(key) + 1 :]) if not rest[len(key) :].startswith("[") else _indexed(key, rest)
    head, _, tail = rest.partition(".")
    return head, tail


def _indexed(key: str, rest: str) -> tuple[str, str]:
    end = rest.index("]", len(key)) + 1 if "]" in rest[len(key) :] else len(rest)
    return rest[:end], rest[end:].removeprefix(".")


def _parts(key: str, index: re.Match[str] | None) -> Sequence[str | int]:
    if index is None:
        return (key,)
    return (*_parts(index[1], INDEX.fullmatch(index[1])), int(index[2])) if index[1] else (int(index[2]),)


def _is_map(value: Any) -> bool:
    return isinstance(value, Mapping)


def _inside(here: Any, key: str | int) -> Any:
    if isinstance(here, Mapping):
        return here.get(key)
    return here[key] if isinstance(here, list) and isinstance(key, int) else None


def _refuse_unknown(data: Mapping[str, Any], here: Any, path: KeyPath, key: str | int, field: str) -> None:
    """Refuse names unknown to the grammar: sections, names of entries, and items of lists."""
    if not path and key not in TOP:
        raise InputError(f"{field}: expected a section of a scene, got {key!r}{hint(str(key), TOP)}")
    if len(path) == 1 and path[0] in SECTIONS and key not in (here or {}):
        raise InputError(f"{field}: expected a name of {path[0]}, got {key!r}{hint(str(key), here or {})}")
    if isinstance(here, list) and not (isinstance(key, int) and key < len(here)):
        raise InputError(f"{field}: expected an item of {path_text(path)} from [0] to [{len(here) - 1}], got [{key}]")
    if len(path) > 1 and here is not None and not isinstance(here, Mapping | list):
        raise InputError(f"{field}: expected no further key, for {path_text(path)} is {here!r}")


# the text -----------------------------------------------------------------------------------------


def _taken_over(text: str, before: Mapping[str, Any], path: KeyPath) -> str:
    """The text with an entry of an included file written into the scene, if the path leads into one."""
    own = written_values(text)
    if len(path) < 2 or path[0] not in SECTIONS or path[1] in (own.get(path[0]) or {}) or INCLUDE not in own:
        return text
    section, name = path[0], path[1]
    if section == "moves":
        words = "expected a move of the scene itself, for the order of moves is that of their files"
        raise InputError(f"{path_text(path)}: {words}; change it in the included file")
    return spliced(without(text, own[INCLUDE], str(name)), (section, name), before[section][name])


def _plain(value: Any) -> Any:
    """Value as YAML writes it."""
    if isinstance(value, Quantity):
        return str(value)
    if isinstance(value, Mapping):
        return {key: _plain(own) for key, own in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(own) for own in value]
    item = getattr(value, "item", None)  # of numpy
    return item() if callable(item) else value


# its files ----------------------------------------------------------------------------------------


def _known(scene: Scene) -> Any:
    return scene.files or None


def _keeps_solids(scene: Scene, paths: Any, values: Any) -> bool:
    """True if the data found at solids, and the files that the scene names, still hold."""
    solid = {name for name, part in scene.parts.items() if part.has_solid}
    touched = any(path[0] == "parts" and (len(path) < 2 or path[1] in solid) for path in paths)
    return bool(scene.files) and not touched and all(_is_number(value) for value in values)


def _is_number(value: Any) -> bool:
    """True if a value names no file."""
    if isinstance(value, str):
        return bool(NUMBER_UNIT.fullmatch(value) or BARE_NUMBER.fullmatch(value))
    return isinstance(value, int | float | Quantity) or hasattr(value, "item")
