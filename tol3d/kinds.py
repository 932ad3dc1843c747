"""The one registration: kinds of scenes, and the mechanisms that understand them.

A bundled mechanism is a line of SHIPPED. Others come with packages, by an entry point of the group
`tol3d.mechanisms`, or are registered by the program that uses them:

    tol3d.register(mechanism)

All are named by import paths. A scene loads the shipped ones whose kinds it names, which `kind: Literal["…"]` in the
files of a mechanism's `grammar/` tells without importing them; any fault in it is reported by all of them.
"""

import re
import warnings
from collections.abc import Iterable, Iterator, Mapping, Set
from functools import cache, lru_cache, reduce
from importlib.metadata import EntryPoint, entry_points
from operator import or_
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from tol3d.errors import InputError
from tol3d.files import Files
from tol3d.import_path import GROUP, named
from tol3d.scene import Grammar, Kinds, Scene, Vocabulary, read_scene
from tol3d.scene.entry import kind_of
from tol3d.scene.schema import SECTIONS
from tol3d.study.system.mechanism import Mechanism

if TYPE_CHECKING:
    from tol3d.study.runs.summary.kinds import SummaryKinds

SHIPPED: Final = (
    "tol3d.gearing.mechanism:GEARING",
    "tol3d.assembly.mechanism:ASSEMBLY",
    "tol3d.gearing.machine.mechanism:MACHINE",
    "tol3d.assembly.linkage.mechanism:LINKAGE",
    "tol3d.gearing.planetary.mechanism:PLANETARY",
    "tol3d.gearing.cycloid.mechanism:CYCLOID",
)

DECLARED: Final = re.compile(r'^    kind: Literal\["(\w+)"\]', re.MULTILINE)

_registered: dict[str, Mechanism] = {}


class MechanismWarning(UserWarning):
    """An installed package offers a mechanism that cannot be used; scenes that need none of its kinds are as ever."""


def register(mechanism: Mechanism) -> None:
    """Let scenes have a mechanism's kinds from now on; one that was registered under its name before is replaced.

    Raises:
        InputError: a kind of it is another mechanism's already.
    """
    others = {name: other for name, other in _registered.items() if name != mechanism.name}
    Grammar((*_brought(), *others.values(), mechanism))
    _registered[mechanism.name] = mechanism


def all_kinds() -> Grammar:
    """The kinds of every mechanism: shipped, installed and registered."""
    return _grammar(all_mechanisms())


def all_mechanisms() -> tuple[Mechanism, ...]:
    """Every mechanism: shipped, installed and registered."""
    return (*_brought(), *_registered.values())


def other_mechanisms() -> tuple[Mechanism, ...]:
    """Mechanisms that packages offer or that were registered; their kinds may still clash with those of others."""
    return (*(mechanism for _, mechanism in _installed()), *_registered.values())


class _EveryKind:
    """See NEEDED_KINDS."""

    def whole(self) -> Grammar:
        """See Kinds."""
        return all_kinds()

    def saying(self, words: Set[str]) -> Grammar:
        """See Kinds."""
        return _grammar_of(path for path in SHIPPED if words & _declared(path))


NEEDED_KINDS: Final[Kinds] = _EveryKind()
"""The kinds of every mechanism, of which those are loaded that a scene names."""


def summary_kinds(summary: Mapping[str, Any] | None = None) -> "SummaryKinds":
    """Summary contents of every mechanism, besides those of all runs.

    Args:
        summary: one, as JSON, to get only those of its mechanism and of the kinds of its measures.
    """
    return _summary_kinds(all_kinds() if summary is None else _grammar_of(_needed_by(summary)))


def load_scene(
    path: Path | str,
    kinds: Grammar | None = None,
    *,
    trust_parts: bool = False,
    run_builders: bool = False,
    files: Files | None = None,
) -> Scene:
    """Read a scene and the files that it names.

    Where it picks features from solids, these are built, unless that was done before; programs that it names are run
    only where that is allowed.

    Args:
        path: the YAML file, or the name of a bundled scene.
        kinds: allowed kinds; default: those of every mechanism.
        trust_parts: whether the scene may name files outside its own folder.
        run_builders: whether programs that it names as builders of its parts may be run.
        files: the contents of the files that it names, if known; then none is read, and nothing built.

    Raises:
        SceneError: one or several messages `file:line: place: what was expected, what came`.
    """
    grammar = all_kinds() if kinds is None else kinds
    return read_scene(path, grammar, trust_parts=trust_parts, run_builders=run_builders, files=files)


def _grammar_of(shipped: Iterable[str]) -> Grammar:
    """The kinds of some shipped mechanisms; all kinds if there are none, or others too."""
    paths = tuple(shipped)
    if not paths or _registered or _offered():
        return all_kinds()
    return _grammar(tuple(_mechanism(named(path), path) for path in paths))


@cache
def _declared(path: str) -> frozenset[str]:
    """Words that a shipped mechanism's grammar declares, by its sources: some may be of other things than entries."""
    folder = Path(__file__).parent.joinpath(*path.split(".")[1:-1], "grammar")
    files = (file for own in ("", *SECTIONS) for file in (folder / own).glob("*.py"))
    return frozenset(word for file in files for word in DECLARED.findall(file.read_text("utf-8")))


def _room(path: str) -> str:
    """The folder of a shipped mechanism, which is its name too."""
    return path.split(".")[-2]


def _needed_by(summary: Mapping[str, Any]) -> Iterator[str]:
    """The shipped mechanisms of a summary, with those that they include: a machine of plain joints may have trains."""
    maker, measures = summary.get("mechanism"), summary.get("measures")
    known = maker if isinstance(maker, Mapping) else {}
    beside = known.get("beside")
    named_there = [known.get("name"), *(beside if isinstance(beside, list) else ())]
    entries = measures.values() if isinstance(measures, Mapping) else ()
    kinds = (entry.get("kind") for entry in entries if isinstance(entry, Mapping))
    words = {kind for kind in kinds if isinstance(kind, str)}
    found = {path for path in SHIPPED if _room(path) in named_there or words & _declared(path)}
    included = {name for path in found for name in _mechanism(named(path), path).includes}
    return (path for path in SHIPPED if path in found or _room(path) in included)


@lru_cache
def _grammar(mechanisms: tuple[Mechanism, ...]) -> Grammar:
    return Grammar(mechanisms)


@lru_cache
def _summary_kinds(grammar: Grammar) -> "SummaryKinds":
    found: SummaryKinds = reduce(or_, map(_added, grammar.vocabularies))
    return found


def _added(vocabulary: Vocabulary) -> "SummaryKinds":
    made = named("tol3d.study.runs.summary.kinds:SummaryKinds")
    presenter = vocabulary.presenter if isinstance(vocabulary, Mechanism) else ""
    shown: SummaryKinds = made(
        presenters=((vocabulary.name, presenter),) if presenter else (),
        published=(vocabulary.published,) if vocabulary.published else (),
    )
    words = tuple(str(kind_of(spec)) for spec in vocabulary.measures)
    if isinstance(vocabulary, Mechanism) and vocabulary.summary:
        found: SummaryKinds = named(vocabulary.summary).stating(words) | shown
        return found
    plain: SummaryKinds = made(plain=tuple((word, presenter) for word in words))
    return plain | shown


@cache
def _brought() -> tuple[Mechanism, ...]:
    """Mechanisms that tol3d ships, then those of installed packages."""
    brought = tuple(_mechanism(named(path), path) for path in SHIPPED)
    for point, offered in _installed():
        try:
            Grammar((*brought, offered))
        except InputError as error:
            _warn_of(point, error)
        else:
            brought = (*brought, offered)
    return brought


@cache
def _offered() -> tuple[EntryPoint, ...]:
    """Entry points of installed packages."""
    return tuple(sorted(entry_points(group=GROUP), key=lambda point: (point.name, point.value)))


@cache
def _installed() -> tuple[tuple[EntryPoint, Mechanism], ...]:
    """Mechanisms that installed packages offer, if they can be loaded."""
    found = list[tuple[EntryPoint, Mechanism]]()
    for point in _offered():
        try:
            found.append((point, _mechanism(point.load(), point.value)))
        except Exception as error:  # whatever a stranger's module raises: other scenes are none of its business
            _warn_of(point, error)
    return tuple(found)


def _warn_of(point: EntryPoint, error: Exception) -> None:
    package = "a package" if point.dist is None else f"{point.dist.name} {point.dist.version}"
    what = f"{package}: its mechanism {point.name} ({point.value}) cannot be used: {error}"
    warnings.warn(what, MechanismWarning, stacklevel=3)


def _mechanism(found: Any, path: str) -> Mechanism:
    if not isinstance(found, Mechanism):
        raise InputError(f"{path}: expected a Mechanism, got {type(found).__name__}")
    return found
