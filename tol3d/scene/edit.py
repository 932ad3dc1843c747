"""A scene's file with other tolerances in it: the rest stays as it was written, comments too."""

from collections.abc import Mapping
from copy import copy
from dataclasses import replace
from io import StringIO
from pathlib import Path
from typing import Any, Final

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq

from tol3d.errors import InputError, unwritable
from tol3d.scene.including import INCLUDE
from tol3d.scene.load import read_scene
from tol3d.scene.schema import Scene
from tol3d.scene.tolerance import ToleranceEntry

UNBROKEN: Final = 10_000  # characters; no entry is broken into lines where its author did not
INDENT: Final = 2

Tolerances = Mapping[str, ToleranceEntry]


def tolerance_lines(tolerances: Tolerances) -> str:
    """Tolerances as lines to paste into the section `tolerances` of a scene."""
    entries = CommentedMap((name, flow(_plain(spec))) for name, spec in tolerances.items())
    return "".join(f"{' ' * INDENT}{line}\n" for line in written(entries).splitlines())


def with_tolerances(scene: Scene, changed: Tolerances) -> Scene:
    """A scene with some tolerances changed or added, in its text too: results are kept by that."""
    text = _edited(scene, changed)
    own = scene.model_copy(update={"tolerances": {**scene.tolerances, **changed}})
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
        with path.open("x", encoding="utf-8") as file:
            file.write(scene.text)
    except FileExistsError:
        raise InputError(f"{path}: expected the name of a new file, there is one already") from None
    except OSError as error:
        raise unwritable(path, error, "choose another file") from None
    if read_scene(path, scene.grammar, files=scene.files).model_dump() != scene.model_dump():
        path.unlink()
        raise InputError(f"{path}: {scene.source} is written in a way that cannot be edited; paste the lines instead")


def _edited(scene: Scene, changed: Tolerances) -> str:
    """A scene's text with these tolerances: only changed keys of an existing one are rewritten.

    One of an included file is left out there, and written into the scene.
    """
    data = loaded_yaml(scene.text)
    if "tolerances" not in data:
        data.insert(list(data).index("moves") if "moves" in data else len(data), "tolerances", CommentedMap())
    tolerances = data["tolerances"]
    for name, spec in changed.items():
        plain = _plain(spec)
        if name not in tolerances:
            if name in scene.tolerances:
                leave_out(data[INCLUDE], name)
            tolerances[name] = flow(plain)
            continue
        entry = copy(tolerances[name])  # another entry may be an alias of it
        before = _plain(scene.tolerances[name])
        for key, value in plain.items():
            if before.get(key) != value:
                entry[key] = flow(value)
        tolerances[name] = entry
    return written(data)


def leave_out(includes: CommentedMap, name: str) -> None:
    """Name an entry of an included file among those that are left out."""
    prefix = max((own for own in includes if name.startswith(f"{own} ")), key=len)
    given = includes[prefix]
    spelt = CommentedMap(file=given) if isinstance(given, str) else copy(given)
    spelt["without"] = CommentedSeq([*spelt.get("without", ()), name.removeprefix(f"{prefix} ")])
    spelt["without"].fa.set_flow_style()
    spelt.fa.set_flow_style()
    includes[prefix] = spelt


def _plain(spec: ToleranceEntry) -> dict[str, Any]:
    """Fields of the entry as stated, the law last."""
    plain: dict[str, Any] = spec.model_dump(mode="json", exclude_unset=True)
    last = {key: plain.pop(key) for key in ("distribution",) if key in plain}
    return {**plain, **last}


def flow(values: Any) -> Any:
    """Values as YAML writes them on one line: {key: value}."""
    if isinstance(values, list):
        items = CommentedSeq(flow(value) for value in values)
        items.fa.set_flow_style()
        return items
    if not isinstance(values, dict):
        return values
    entries = CommentedMap((key, flow(value)) for key, value in values.items())
    entries.fa.set_flow_style()
    return entries


def loaded_yaml(text: str) -> Any:
    """A scene's text with all that is needed to write it again as it was."""
    return _yaml().load(text)


def _yaml() -> YAML:
    yaml = YAML()
    yaml.width, yaml.preserve_quotes = UNBROKEN, True
    return yaml


def written(data: Any) -> str:
    """The text that `loaded_yaml` read."""
    stream = StringIO()
    _yaml().dump(data, stream)
    return stream.getvalue()
