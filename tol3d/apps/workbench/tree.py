"""The tree of a scene: parts with their features, tolerances, moves and measures, each with the line that states it."""

from collections.abc import Iterator, Mapping
from typing import Any, Final

from tol3d.report.html.blocks import Inside, Markup, tag
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath

SECTIONS: Final = ("parts", "tolerances", "moves", "measures")


def tree(scene: Scene) -> Markup:
    """The sections of a scene as lists that fold."""
    return tag("div", *(_section(scene, name) for name in SECTIONS), class_="tree")


def _section(scene: Scene, name: str) -> Markup | None:
    entries: Mapping[str, Any] = getattr(scene, name)
    if not entries:
        return None
    rows = (_entry(scene, (name, own), spec) for own, spec in entries.items())
    return tag(
        "details", tag("summary", name, " ", tag("span", str(len(entries)), class_="dim")), tag("ul", *rows), open=""
    )


def _entry(scene: Scene, path: KeyPath, spec: Any) -> Markup:
    """An entry, with its features where it has some."""
    below = [tag("li", _button(scene, own, str(own[-1]), "")) for own in _features(path, spec)]
    button = _button(scene, path, str(path[-1]), _words(spec))
    inside: list[Inside] = [tag("details", tag("summary", button), tag("ul", *below))] if below else [button]
    return tag("li", *inside)


def _button(scene: Scene, path: KeyPath, name: str, words: str) -> Markup:
    """A name that leads to its line; of an included file's entry to the line that includes it."""
    place = scene.origin.place(path)
    line = place.line if not place.file else None
    about = tag("span", words, class_="dim") if words else None
    return tag(
        "button", name, about, type="button", data_line=line, data_section=str(path[0]), data_name=str(path[1]),
        data_feature=f"{path[1]}.{path[3]}" if path[2:3] == ("features",) else None,
        title=f"{place.file}:{place.line}" if place.file else None,
    )  # fmt: skip


def _features(path: KeyPath, spec: Any) -> Iterator[KeyPath]:
    features = getattr(spec, "features", None)
    if isinstance(features, Mapping):
        yield from ((*path, "features", str(name)) for name in features)


def _words(spec: Any) -> str:
    """Kind of an entry, and of what it is."""
    kind, of = str(getattr(spec, "kind", "")).replace("_", " "), getattr(spec, "of", "")
    return f" {kind}{f' of {of}' if isinstance(of, str) and of else ''}"


def parts_of(scene: Scene, lines: Iterator[str] | tuple[str, ...], entries: Mapping[str, tuple[str, ...]]) -> list[str]:
    """Parts that some lines of the scene are about.

    Args:
        scene: the scene.
        lines: their names.
        entries: tolerances of the scene by line.
    """
    found = dict[str, None]()
    for line in lines:
        for name in entries.get(line, (line,)):
            of = getattr(scene.tolerances.get(name), "of", None)
            for about in [of] if isinstance(of, str) else of if isinstance(of, list | tuple) else []:
                part = str(about).partition(".")[0]
                if part in scene.parts:
                    found[part] = None
    return [*found]
