"""Included files: their parts, tolerances, moves and measures, each name with that of the include in front.

An included file is a scene, or parts of one, that lies in the scene's folder and uses no names but its own. Its entries
come before those of the scene, but its moves after the moves by which the scene places parts of it.
"""

import posixpath
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from pydantic import ValidationError

from tol3d.errors import SceneError
from tol3d.files import FileContent, Files, UnreadableFileError, contained, read_contained
from tol3d.scene.bases import laws_in
from tol3d.scene.correlation import CORRELATIONS
from tol3d.scene.including import INCLUDE, IncludeSpec, Including
from tol3d.scene.nearest import hint
from tol3d.scene.place import Children, KeyPath, Node, Origin, Place, Places, branch, plain
from tol3d.scene.references import bad_names, refuse
from tol3d.scene.schema import SECTIONS, Scene
from tol3d.scene.text import MAX_BYTES, MAX_NODES, near_file, scene_text
from tol3d.scene.vector import Vector
from tol3d.statistics.distributions.drawn import DEFAULT_LAW
from tol3d.units import Quantity, shown, summed

if TYPE_CHECKING:
    from tol3d.scene.grammar import Kinds

MOST_PARTS: Final = 2000  # of a scene; placing one takes 10 ms and 1 MB before any trial, and 300 are what is measured
DEEPEST: Final = 8  # files that include each other; memory ends none, a reader's patience does
LEFT_OUT: Final = ("scene", "description", "study", "published", INCLUDE)  # what only the scene itself says
SCENE_OF_RUNS: Final = "scene.yaml"  # the name under which a run keeps its scene

Sections = Mapping[str, dict[Any, tuple[Place, Node]]]
"""Entries by section and name, each with the place of its name."""


@dataclass(frozen=True)
class _Read:
    """An included file.

    Args:
        name: from the scene's folder.
        sections: its entries, those that it includes too.
        uses: of each entry, the fields that name others, each with that name.
        parts: as they are understood.
        correlations: as they are written.
    """

    name: str
    sections: Mapping[str, Children]
    uses: Mapping[KeyPath, Sequence[tuple[KeyPath, str]]]
    parts: Mapping[str, Any]
    correlations: Children


@dataclass
class Includes:
    """The files that a scene includes, each read once.

    Args:
        source: the scene's file.
        kinds: those of scenes.
        known: the files' contents, if known; then none is read.
    """

    source: Path
    kinds: "Kinds"
    known: Files | None
    files: dict[str, FileContent] = field(default_factory=dict)
    """Files that were read, by names from the scene's folder."""
    _read: dict[str, _Read] = field(default_factory=dict)
    _law: Any = None
    """The default law that the scene itself states, which is that of its files too."""

    def expanded(self, top: Node, origin: Origin, chain: tuple[str, ...] = ()) -> Node:
        """A scene's values, or those of a file that it includes, with the entries of its includes.

        Args:
            top: the values.
            origin: their source.
            chain: the files that include each other, the last one being `top`; none for the scene itself.

        Raises:
            SceneError: one or several messages.
        """
        _refuse_many(len(top.held("parts")), 0, origin, ("parts",))
        if not chain and DEFAULT_LAW in top.children:
            self._law = plain(top.children[DEFAULT_LAW][1])
        if INCLUDE not in top.children:
            return top
        own: Sections = {section: dict(top.held(section)) for section in SECTIONS}
        found: Sections = {section: {} for section in SECTIONS}
        moves: list[Sections] = []
        correlations: list[tuple[Place, Node]] = []
        for name, spec in self._specs(top, origin).items():
            read = self._file(spec.file, origin, (INCLUDE, name), chain)
            _refuse_many(*_together((own, found, read.sections)), origin, (INCLUDE, name))
            named = _named(read, name, spec, origin)
            for section in SECTIONS:
                _refuse_same(section, named[section], found[section] | own[section], origin)
                found[section].update(named[section])
            moves.append(named)
            correlations += [(place, _between(node, name)) for place, node in read.correlations.values()]
        top = _with_correlations(top, correlations)
        return _with_sections(top, {s: found[s] | own[s] if s != "moves" else _ordered(own, moves) for s in SECTIONS})

    def _specs(self, top: Node, origin: Origin) -> Mapping[str, IncludeSpec]:
        data = {INCLUDE: plain(top.children[INCLUDE][1])}
        try:
            return Including.model_validate(data).include
        except ValidationError as error:
            raise SceneError(*self.kinds.whole().messages(error, data, origin)) from None

    def _file(self, file: str, origin: Origin, here: KeyPath, chain: tuple[str, ...]) -> _Read:
        name = posixpath.normpath(posixpath.join(posixpath.dirname(chain[-1]) if chain else "", file))
        around = (self.source.name, *chain)
        if not contained(name):
            raise origin.error(here, f"expected a file in the scene's folder, got {shown(file)}, which lies outside")
        if name in around:
            ring = " includes ".join((*around[around.index(name) :], name))
            raise origin.error(here, f"expected a file that does not include itself, got a ring: {ring}")
        if name == SCENE_OF_RUNS:
            raise origin.error(here, f"expected another name than {name}, by which a run keeps the scene itself")
        if len(chain) >= DEEPEST:
            raise origin.error(here, f"expected at most {DEEPEST} files that include each other, got more")
        if name not in self._read:
            self._read[name] = self._understood(name, self._content(name, origin, here), (*chain, name))
        return self._read[name]

    def _content(self, name: str, origin: Origin, here: KeyPath) -> FileContent:
        if self.known is not None:
            if name not in self.known:
                raise origin.error(here, f"expected {shown(name)} among the files of the run, found none")
            return self.known[name]
        folder = self.source.parent
        try:
            return FileContent(folder / name, read_contained(folder / name, folder, MAX_BYTES))
        except UnreadableFileError as error:
            words = f"expected a scene in the scene's folder, got {shown(name)}: {error}{near_file(folder / name)}"
            raise origin.error(here, words) from None

    def _understood(self, name: str, file: FileContent, chain: tuple[str, ...]) -> _Read:
        self.files[name] = file
        top, origin = scene_text(file.path, file.content, included=True)
        if not {"parts", INCLUDE} & top.children.keys():
            raise origin.error((), "expected a scene, or the parts of one (parts:), for it is included; found none")
        top = self.expanded(top, origin, chain)
        own = replace(origin, places=Places(top))
        data = {key: plain(child) for key, (_, child) in top.children.items() if key not in LEFT_OUT}
        law = data.setdefault(DEFAULT_LAW, self._law)
        part: Scene = self.kinds.whole().fragment.model_validate(data, context=own)
        refuse(part, bad_names(part))
        if law != self._law:
            _refuse_other_law(part, own, name)
        for path, entry in part.entries().items():
            for place, _ in entry.file_names():
                top = _changed(top, (*path, *place), partial(posixpath.join, posixpath.dirname(name)))
        uses = {
            path: [(reference.path, reference.name) for reference in entry.references()]
            for path, entry in part.entries().items()
        }
        return _Read(
            name, {section: top.held(section) for section in SECTIONS}, uses, part.parts, top.held(CORRELATIONS)
        )


def _refuse_other_law(part: Scene, origin: Origin, name: str) -> None:
    """Refuse a file's own default law, as the scene has another or none, if it decides the meaning of a tolerance."""
    for path, entry in part.entries().items():
        if any(law.by_default_law for law in laws_in(entry)):
            words = f"expected limits of {name} to be read by the scene's own {DEFAULT_LAW}, got another"
            raise origin.error(path, f"{words}; state the same {DEFAULT_LAW} in both, or laws in {name}")


# limits -------------------------------------------------------------------------------------------


def _together(several: Sequence[Mapping[str, Children]]) -> tuple[int, int]:
    """Number of parts, and number of values."""
    values = (child.size for own in several for entries in own.values() for _, child in entries.values())
    return sum(len(own["parts"]) for own in several), sum(values)


def _refuse_many(parts: int, values: int, origin: Origin, here: KeyPath) -> None:
    if parts > MOST_PARTS:
        raise origin.error(here, f"expected at most {MOST_PARTS} parts in a scene, got {parts} up to here")
    if values > MAX_NODES:
        raise origin.error(here, f"expected at most {MAX_NODES} values in a scene, included ones too, got more")


def _refuse_same(section: str, new: Children, there: Children, origin: Origin) -> None:
    for name in new:
        if name in there:
            own, other = (Origin(origin.source).message((), "", entries[name][0]) for entries in (new, there))
            words = f"expected a name of its own, got {str(name)!r} of {own}, which also stands in {other}"
            raise origin.error((section, name), f"{words}; rename one", there[name][0])


# entries under other names ------------------------------------------------------------------------


def _named(read: _Read, name: str, spec: IncludeSpec, origin: Origin) -> Sections:
    """The entries of a file as the scene has them."""
    known = [str(entry) for entries in read.sections.values() for entry in entries]
    for k, missing in enumerate(spec.without):
        if missing not in known:
            here = (INCLUDE, name, "without", k)
            raise origin.error(here, f"expected a name of {read.name}, got {missing!r}{hint(missing, known)}")
    found: Sections = {section: {} for section in SECTIONS}
    for section, entries in read.sections.items():
        for own, (place, node) in entries.items():
            if own in spec.without:
                continue
            keys = []
            for path, used in read.uses[section, own]:
                changed = _changed(node, path, _prefixing(name, used))
                if changed is node and path[-1] == used:
                    keys.append(path)
                node = changed
            for path in sorted(keys, key=len, reverse=True):
                node = _rekeyed(node, path, f"{name} {path[-1]}")
            if section == "parts" and spec.at is not None:
                node = _moved(node, read, str(own), spec.at, origin, (INCLUDE, name, "at"))
            found[section][f"{name} {own}"] = place, node
    return found


def _prefixing(name: str, used: str) -> Callable[[str], str]:
    """Function that puts the name of an include before a used name, or before one of its features."""
    return lambda text: f"{name} {text}" if text == used or text.startswith(f"{used}.") else text


def _changed(node: Node, path: KeyPath, change: Callable[[str], str]) -> Node:
    """Node with the text of a field changed; the same node if nothing changes."""
    if isinstance(node.value, str):
        text = change(node.value)
        return node if text == node.value else node._replace(value=text)
    if not path or path[0] not in node.children:
        return node
    place, child = node.children[path[0]]
    changed = _changed(child, path[1:], change)
    return node if changed is child else node._replace(children={**node.children, path[0]: (place, changed)})


def _rekeyed(node: Node, path: KeyPath, name: str) -> Node:
    """Node with another key at a path."""
    children = dict(node.children)
    if path[0] in children and len(path) > 1:
        place, child = children[path[0]]
        children[path[0]] = place, _rekeyed(child, path[1:], name)
    elif path[0] in children:
        children = {name if key == path[0] else key: child for key, child in children.items()}
    return node._replace(children=children)


def _moved(node: Node, read: _Read, part: str, at: Vector, origin: Origin, here: KeyPath) -> Node:
    """A part with its origin elsewhere."""
    spec = read.parts[part]
    if not spec.origin_field:
        words = (
            f"expected none, for {part!r} of {read.name} is {spec.words or spec.kind}, which has no place of its own"
        )
        raise origin.error(here, words)
    place = origin.place(here)
    old, steps = node, list(spec.origin_field)
    while steps and steps[0] in old.children:
        old = old.children[steps.pop(0)][1]
    told = [Quantity.parse(child.value) for _, child in old.children.values()] if not steps else []
    sums = [summed(((1, own), (1, before))) for own, before in zip(at, told, strict=True)] if told else at
    new = branch([], place, {k: (place, Node(str(own), place)) for k, own in enumerate(sums)})
    return _put(node, spec.origin_field, new)


def _put(node: Node, path: KeyPath, new: Node) -> Node:
    if not path:
        return new
    _, child = node.children.get(path[0], (new.place, branch({}, new.place, {})))
    return branch({}, node.place, {**node.children, path[0]: (new.place, _put(child, path[1:], new))})


def _between(node: Node, name: str) -> Node:
    """A correlation between contributors under the name of an include."""
    place, names = node.children["between"]
    named = {k: (own, child._replace(value=f"{name} {child.value}")) for k, (own, child) in names.children.items()}
    return branch({}, node.place, {**node.children, "between": (place, branch([], names.place, named))})


def _with_correlations(top: Node, included: Sequence[tuple[Place, Node]]) -> Node:
    """Node with correlations of included files before its own."""
    if not included:
        return top
    place, own = top.children.get(CORRELATIONS, top.children[INCLUDE])
    every = [*included, *(own.children.values() if CORRELATIONS in top.children else ())]
    return branch({}, top.place, {**top.children, CORRELATIONS: (place, branch([], place, dict(enumerate(every))))})


def _with_sections(top: Node, sections: Sections) -> Node:
    children = {key: child for key, child in top.children.items() if key != INCLUDE}
    for section, entries in sections.items():
        place, node = top.children.get(section, top.children[INCLUDE])
        if section not in children or isinstance(node.value, dict):
            children[section] = place, branch({}, place, entries)
    return branch({}, top.place, children)


def _ordered(sections: Sections, included: Sequence[Sections]) -> dict[Any, tuple[Place, Node]]:
    """All moves: those of a file after each by which the scene places one of its parts, else before the scene's own."""
    before: dict[Any, tuple[Place, Node]] = {}
    after: dict[Any, dict[Any, tuple[Place, Node]]] = {}
    first: dict[Any, Any] = {}
    for name, (_, node) in sections["moves"].items():
        first.setdefault(_part(node), name)
    order = {name: k for k, name in enumerate(sections["moves"])}
    for file in included:
        placed = {_part(node) for _, node in file["moves"].values()}
        placing = [first[part] for part in file["parts"] if part in first and part not in placed]
        target = after.setdefault(max(placing, key=order.__getitem__), {}) if placing else before
        target.update(file["moves"])
    for name, child in sections["moves"].items():
        before |= {name: child, **after.get(name, {})}
    return before


def _part(move: Node) -> Any:
    """The part that a move places, if it names one."""
    return move.children["part"][1].value if "part" in move.children else None
