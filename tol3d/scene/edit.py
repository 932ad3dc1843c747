"""A scene's file with other tolerances and limits in it: the rest stays as it was written, comments too."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from tol3d.errors import InputError, unwritable
from tol3d.scene.bases import ToleranceEntry
from tol3d.scene.including import INCLUDE
from tol3d.scene.load import read_scene
from tol3d.scene.place import KeyPath
from tol3d.scene.schema import Scene
from tol3d.scene.splice import INDENT, flow_text, spliced, written_values
from tol3d.units import MICRO_SIGNS, NUMBER_UNIT, Quantity

Tolerances = Mapping[str, ToleranceEntry]


def tolerance_lines(tolerances: Tolerances) -> str:
    """Tolerances as lines to paste into the section `tolerances` of a scene."""
    return "".join(f"{' ' * INDENT}{flow_text(name)}: {flow_text(_plain(spec))}\n" for name, spec in tolerances.items())


def with_tolerances(scene: Scene, changed: Tolerances) -> Scene:
    """A scene with some tolerances changed or added, in its text too: results are kept by that."""
    text = _edited(scene, changed)
    own = scene.model_copy(update={"tolerances": {**scene.tolerances, **changed}})
    return own.read_from(replace(scene.origin, text=text))


def with_limits(scene: Scene, changed: Mapping[str, Mapping[str, Quantity | None]]) -> Scene:
    """A scene with other limits of some measures, in its text too.

    Args:
        scene: the scene.
        changed: by measure and field, `lower_limit` or `upper_limit`, the limit; None for none.

    Raises:
        InputError: a measure of an included file.
    """
    text, measures = scene.text, dict(scene.measures)
    for name, limits in changed.items():
        written = (written_values(text).get("measures") or {}).get(name)
        if written is None:
            raise InputError(f"{name}: expected a measure of the scene, got one of an included file; change it there")
        for field, limit in limits.items():
            value = None if limit is None else str(limit)
            text = spliced(text, ("measures", name, field), _as_spelt(value, written.get(field)))
        measures[name] = measures[name].model_copy(update={**limits})
    own = scene.model_copy(update={"measures": measures})
    return own.read_from(replace(scene.origin, text=text))


def write_scene(scene: Scene, path: Path) -> None:
    """Write a scene's text to a new file.

    Raises:
        InputError: there is a file already, it cannot be written, or names files that would not be found from there.
    """
    if scene.file_names and path.resolve().parent != scene.folder.resolve():
        raise InputError(
            f"{path}: expected a file in {scene.folder}, for the scene names files by their way from there"
        )
    try:
        with path.open("x", encoding="utf-8", newline="") as file:
            file.write(scene.text)
    except FileExistsError:
        raise InputError(f"{path}: expected the name of a new file, there is one already") from None
    except OSError as error:
        raise unwritable(path, error, "choose another file") from None
    read = read_scene(path, scene.grammar, files=scene.files)
    if read.model_dump(warnings=False) != scene.model_dump(warnings=False):  # picked features are of no kind there
        path.unlink()
        raise InputError(f"{path}: {scene.source} is written in a way that cannot be edited; paste the lines instead")


def _edited(scene: Scene, changed: Tolerances) -> str:
    """A scene's text with these tolerances: only changed keys of an existing one are rewritten.

    One of an included file is left out there, and written into the scene.
    """
    text = scene.text
    for name, spec in changed.items():
        own, plain = written_values(text), _plain(spec)
        written = (own.get("tolerances") or {}).get(name)
        if written is None:
            if name in scene.tolerances and name not in scene.origin.general:
                text = without(text, own[INCLUDE], name)
            text = spliced(text, ("tolerances", name), plain)
            continue
        before = _plain(scene.tolerances[name])
        for path, value in _differences(before, {**before, **plain}, written):
            text = spliced(text, ("tolerances", name, *path), value)
    return text


def _differences(before: Any, after: Any, written: Any) -> Iterator[tuple[KeyPath, Any]]:
    """Places that differ, with their new values: where their text has such places, single numbers and words.

    Args:
        before, after: a value of the scene.
        written: its text's.
    """
    match before, after, written:
        case dict(), dict(), dict() if before.keys() <= after.keys():
            keys: Iterable[str | int] = after
        case list(), list(), list() if len(before) == len(after) == len(written):
            keys = range(len(after))
        case _:
            if before != after:
                yield (), _as_spelt(after, written)
            return
    for key in keys:
        own = (each.get(key) if isinstance(each, dict) else each[key] for each in (before, after, written))
        yield from (((key, *path), value) for path, value in _differences(*own))


def _as_spelt(value: Any, written: Any) -> Any:
    """A quantity with the unit as it is spelt in the text that it replaces; any other value as it is."""
    new, old = (NUMBER_UNIT.fullmatch(own) if isinstance(own, str) else None for own in (value, written))
    if new and old and old[2].translate(MICRO_SIGNS) == new[2]:
        return f"{written[: old.start(1)]}{new[1]}{written[old.end(1) :]}"
    return value


def without(text: str, includes: Mapping[str, Any], name: str) -> str:
    """A scene's text in which an entry of an included file is left out."""
    prefix = max((include for include in includes if name.startswith(f"{include} ")), key=len)
    given = includes[prefix]
    spelt = {"file": given} if isinstance(given, str) else given
    left_out = [*spelt.get("without", ()), name.removeprefix(f"{prefix} ")]
    return spliced(text, (INCLUDE, prefix), {**spelt, "without": left_out})


def _plain(spec: ToleranceEntry) -> dict[str, Any]:
    """Fields of the entry as stated, the law last."""
    plain: dict[str, Any] = spec.model_dump(mode="json", exclude_unset=True)
    last = {key: plain.pop(key) for key in ("distribution",) if key in plain}
    return {**plain, **last}
