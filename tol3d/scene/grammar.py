"""The kinds of entry that scenes may have, and the class of such scenes."""

import pkgutil
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from functools import cached_property, lru_cache
from importlib import import_module
from types import ModuleType
from typing import Annotated, Any, Final, Protocol, Union

from pydantic import Field, ValidationError, create_model

from tol3d.errors import InputError, Problem
from tol3d.import_path import REGISTRY
from tol3d.scene.bases import MeasureEntry, MoveSpec, PartSpec, ToleranceEntry, laws_in
from tol3d.scene.entry import Entry, kind_of
from tol3d.scene.implausible import warned
from tol3d.scene.name import Name
from tol3d.scene.options import Engines, Option, StudyOptions, options_of
from tol3d.scene.place import KeyPath, Origin
from tol3d.scene.problems import messages
from tol3d.scene.published import PublishedFigures
from tol3d.scene.published.measure import published_column_class
from tol3d.scene.schema import PUBLISHED_MEANS, SECTIONS, Scene, StudySpec, study_spec_class
from tol3d.statistics.distributions import DistributionSpec
from tol3d.statistics.distributions.stated import SHIPPED, Laws, word_of

Check = Callable[[Scene], Iterator[tuple[KeyPath, str]]]
"""Check across entries whose names all exist: gives key path and finished sentence of each inconsistency."""

General = Callable[[Scene], Iterator[tuple[str, Mapping[str, Any]]]]
"""Tolerances of dimensions without one of their own, by name, as a scene writes them."""

REQUIRED: Final = frozenset(("parts", "moves", "measures"))  # sections that every scene has, with an entry at least

SECTIONS_MEAN: Final[Mapping[str, str]] = {
    "parts": "parts, by name",
    "tolerances": "deviations of parts, by name",
    "moves": "placement of parts, by name and in this order",
    "measures": "quantities read from each build, by name",
}

BASES: Final[Mapping[str, type[Entry]]] = {
    "parts": PartSpec,
    "tolerances": ToleranceEntry,
    "moves": MoveSpec,
    "measures": MeasureEntry,
}


@dataclass(frozen=True)
class Vocabulary:
    """Kinds of entry that belong together.

    Args:
        name: of them all, for messages and for others that build on it.
        parts, tolerances, moves, measures: the kinds of each section.
        checks: conditions across entries.
        warnings: of probable slips: numbers that could be built.
        general: tolerances that dimensions without one of their own take where the scene has general ones.
        includes: names of vocabularies whose kinds may stand beside these in one scene, which is then this one's.
        extends: names of vocabularies in whose scenes these kinds may stand; the scene stays theirs.
        distributions: laws that tolerances of any scene may state besides those that tol3d ships.
        options: keys of `study` that scenes of its kinds may have besides.
        published: keys that columns of `published` may have besides measures: sections of summary.json.
        engines: words of study.engine, besides "analytic"; the first is the default.
        witness: the one of them that can check the others, if there is one.
        settle: import path `package.module:name` of the finder of numbers that a scene leaves to its solids, see
            tol3d.scene.load; "" where scenes say all themselves.
        other_kinds: words of the field that are no kind here, each with its replacement.
        other_keys: the same of keys and choices.

    Raises:
        InputError: a class stands where it is none of the section's kinds, or lacks a method that it must have.
    """

    name: str
    parts: tuple[type[PartSpec], ...] = ()
    tolerances: tuple[type[ToleranceEntry], ...] = ()
    moves: tuple[type[MoveSpec], ...] = ()
    measures: tuple[type[MeasureEntry], ...] = ()
    checks: tuple[Check, ...] = ()
    warnings: tuple[Check, ...] = ()
    general: tuple[General, ...] = ()
    includes: tuple[str, ...] = ()
    extends: tuple[str, ...] = ()
    distributions: tuple[type[DistributionSpec], ...] = ()
    options: type[StudyOptions] | None = None
    published: type[PublishedFigures] | None = None
    engines: tuple[str, ...] = ("exact",)
    witness: str = ""
    settle: str = ""
    other_kinds: tuple[tuple[str, str], ...] = ()
    other_keys: tuple[tuple[str, str], ...] = ()

    def __post_init__(self) -> None:
        for section, base in BASES.items():
            for spec in self.specs(section):
                if not issubclass(spec, base) or kind_of(spec) is None:
                    wanted = f"subclasses of {base.__name__} whose kind is a literal"
                    raise InputError(f"{self.name}.{section}: expected {wanted}, got {spec.__name__}")
                if lacking := sorted(spec.__abstractmethods__):
                    raise InputError(f"{self.name}.{section}: {spec.__name__} lacks {', '.join(lacking)}")
        for law in self.distributions:
            if not issubclass(law, DistributionSpec) or word_of(law) is None:
                wanted = f"subclasses of {DistributionSpec.__name__} whose kind is a literal"
                raise InputError(f"{self.name}.distributions: expected {wanted}, got {law.__name__}")
        for argument, own in (("options", self.options), ("published", self.published)):
            for name, field in own.model_fields.items() if own else ():
                if field.is_required():
                    raise InputError(f"{self.name}.{argument}: expected a default of {name}, found none")

    def specs(self, section: str) -> tuple[type[Entry], ...]:
        """The kinds of a section."""
        specs: tuple[type[Entry], ...] = getattr(self, section)
        return specs


class Kinds(Protocol):
    """Kinds of scenes, loaded as a scene needs them."""

    def whole(self) -> "Grammar":
        """All of them."""

    def saying(self, words: Set[str]) -> "Grammar":
        """Grammar of the vocabularies that have some words; of all of them if that is not known."""


def registered_kinds() -> Kinds:
    """The kinds of every mechanism that is known: shipped, installed and registered."""
    found: Kinds = import_module(REGISTRY).NEEDED_KINDS
    return found


@dataclass(frozen=True)
class Grammar:
    """Grammar of scenes: the kinds of several vocabularies. Equal where these are; pickles.

    A shared kind belongs to each vocabulary that has it.

    Raises:
        InputError: a kind stands for two things or lacks a piece of its own, or a section has none.
    """

    vocabularies: tuple[Vocabulary, ...]

    def __post_init__(self) -> None:
        for section in SECTIONS:
            words = {each.name: [str(kind_of(own)) for own in self._first(each, section)] for each in self.vocabularies}
            if not any(words.values()):
                raise InputError(f"expected kinds of {section} in one vocabulary at least, found none")
            _refuse_ambiguity(f"a kind of its own in {section}", {}, words)
            for vocabulary in self.vocabularies:
                for spec in vocabulary.specs(section):
                    for lack in spec.lacking():
                        raise InputError(f"{vocabulary.name}.{section}: {kind_of(spec)} lacks {lack}")
        laws = {each.name: [str(word_of(law)) for law in each.distributions] for each in self.vocabularies}
        _refuse_ambiguity("a kind of its own in distributions", {str(word_of(law)): "tol3d" for law in SHIPPED}, laws)
        options = {each.name: [*each.options.model_fields] for each in self.vocabularies if each.options}
        _refuse_ambiguity(
            "an option of its own in study", dict.fromkeys(StudySpec.model_fields, "every study"), options
        )
        published = {each.name: [*each.published.model_fields] for each in self.vocabularies if each.published}
        taken = dict.fromkeys(published_column_class().model_fields, "every run")
        _refuse_ambiguity("a key of its own in published", taken, published)

    def whole(self) -> "Grammar":
        """See Kinds."""
        return self

    def saying(self, words: Set[str]) -> "Grammar":
        """See Kinds: it is loaded already."""
        return self

    def kinds(self, section: str) -> Mapping[str, type[Entry]]:
        """The kinds of a section by their words, in the order of registration."""
        return {str(kind_of(spec)): spec for vocabulary in self.vocabularies for spec in vocabulary.specs(section)}

    def instead_of_kind(self, word: object) -> str:
        """Replacement for a kind that is not known; "" where no vocabulary gives one."""
        return _said_of(word, (vocabulary.other_kinds for vocabulary in self.vocabularies))

    def instead_of_key(self, word: object) -> str:
        """The same of a key or a choice."""
        return _said_of(word, (vocabulary.other_keys for vocabulary in self.vocabularies))

    @property
    def laws(self) -> Laws:
        """The kinds of law that tolerances may state: those that tol3d ships, then the vocabularies' own."""
        return (*SHIPPED, *(law for vocabulary in self.vocabularies for law in vocabulary.distributions))

    @property
    def engines(self) -> Engines:
        """Engines for scenes of these kinds."""
        names = dict.fromkeys(engine for vocabulary in self.vocabularies for engine in vocabulary.engines)
        return Engines(
            tuple(names), tuple(vocabulary.witness for vocabulary in self.vocabularies if vocabulary.witness)
        )

    @property
    def scene(self) -> type[Scene]:
        """The class of scenes of these kinds: it validates, and writes their JSON Schema."""
        return _scene_class(self)

    @property
    def fragment(self) -> type[Scene]:
        """The class of files that scenes include: no section must be there, and no name."""
        return _scene_class(self, required=frozenset())

    def messages(self, error: ValidationError, data: Any, origin: Origin) -> list[Problem]:
        """Errors of pydantic in the plain values of a scene, in the user's words, each with its place."""
        return messages(error, data, origin, self)

    def problems(self, scene: Scene) -> Iterator[tuple[KeyPath, str]]:
        """Errors that the vocabularies find across entries."""
        if scene.envelope and not any(
            "envelope" in type(tolerance).model_fields for tolerance in scene.tolerances.values()
        ):
            yield ("envelope",), "expected a size tolerance, whose limits bound a form, found none; take it out"
        for vocabulary in self.vocabularies:
            for check in vocabulary.checks:
                yield from check(scene)

    def warnings(self, scene: Scene) -> Iterator[Problem]:
        """Warnings of the vocabularies, each with its place; the files of the scene are read, its solids known."""
        for vocabulary in self.vocabularies:
            for check in vocabulary.warnings:
                yield from (warned(scene.origin, path, sentence) for path, sentence in check(scene))

    def general(self, scene: Scene) -> dict[str, Mapping[str, Any]]:
        """Tolerances that dimensions take from the general ones of a scene, by names that it does not have."""
        if scene.general is None:
            return {}
        found = (own for vocabulary in self.vocabularies for make in vocabulary.general for own in make(scene))
        return {name: own for name, own in found if name not in scene.tolerances}

    def vocabulary_of(self, scene: Scene) -> Vocabulary:
        """The vocabulary that understands all of a scene: its own kinds, those that it includes or that extend it.

        Of several it is the one whose are all moves, else the first that is registered: one that both includes and
        extends another has the scenes of its own moves alone, and the other one those where both have moves.

        Raises:
            SceneError: the kinds of the scene are of several, none of which understands the others.
        """
        used = self._used(scene)
        found = [
            vocabulary
            for vocabulary in self.vocabularies
            if vocabulary.name in used and used.keys() <= self._understood(vocabulary)
        ]
        moves = {type(move) for move in scene.moves.values()}
        if found:
            return next((each for each in found if moves <= set(each.moves)), found[0])
        odd = next((own for own in reversed([*used]) if self._go_together(used.keys() - {own})), list(used)[-1])
        kinds = " and ".join(f"{first[1]!r} of {own}" for own, first in used.items())
        words = f"kinds of {' and '.join(used)} do not go together in one scene, got {kinds}"
        advice = self._joining(used.keys()) or f"take out {odd}"
        raise scene.refuse(used[odd], f"{words}; {advice}, or make two scenes")

    def understands(self, scene: Scene) -> bool:
        """True if a vocabulary understands all of a scene."""
        return self._go_together(self._used(scene).keys())

    def _go_together(self, names: Set[str]) -> bool:
        return any(
            vocabulary.name in names and names <= self._understood(vocabulary) for vocabulary in self.vocabularies
        )

    def _joining(self, names: Set[str]) -> str:
        """The moves of a vocabulary that understands some others and whose own kinds are not there; or nothing."""
        joining = next((vocabulary for vocabulary in self.vocabularies if names <= self._understood(vocabulary)), None)
        kinds = [kind_of(spec) for spec in joining.moves] if joining else []
        return "join them by " + " or ".join(f"a move of kind {kind}" for kind in kinds) if kinds else ""

    def vocabularies_of(self, scene: Scene) -> tuple[Vocabulary, ...]:
        """The vocabularies whose kinds a scene has, in the order of registration."""
        used = self._used(scene)
        return tuple(vocabulary for vocabulary in self.vocabularies if vocabulary.name in used)

    def lawgivers_of(self, scene: Scene) -> tuple[Vocabulary, ...]:
        """The vocabularies whose distributions a scene states."""
        used = {type(law) for entry in scene.tolerances.values() for law in laws_in(entry)}
        return tuple(vocabulary for vocabulary in self.vocabularies if used & set(vocabulary.distributions))

    def options_of(self, scene: Scene) -> Mapping[str, Option]:
        """The values of the options that vocabularies of a scene's kinds add to its study.

        Raises:
            SceneError: the study has an option of a vocabulary none of whose kinds the scene has.
        """
        used = self.vocabularies_of(scene)
        for vocabulary in self.vocabularies:
            for name in vocabulary.options.model_fields if vocabulary.options and vocabulary not in used else ():
                if name in scene.study.model_fields_set:
                    raise scene.refuse(
                        ("study", name), f"no kind of {vocabulary.name} is in the scene; take out {name}"
                    )
        values = (options_of(scene.options(each.options), each.options) for each in used if each.options)
        return {name: value for each in values for name, value in each.items()}

    def _used(self, scene: Scene) -> Mapping[str, KeyPath]:
        """The vocabularies whose kinds a scene has, each with its first entry.

        A shared kind belongs to the vocabulary whose other kinds the scene has; without such, to the first that has it.
        """
        used: dict[str, KeyPath] = {}
        entries = [
            (self._owners[type(entry)], (section, name))
            for section in SECTIONS
            for name, entry in scene.section(section).items()
        ]
        for owners, path in sorted(entries, key=lambda entry: len(entry[0])):
            if len(owners) == 1 or used.keys().isdisjoint(owners):
                used.setdefault(owners[0], path)
        return used

    def _understood(self, vocabulary: Vocabulary) -> set[str]:
        own = {vocabulary.name, *vocabulary.includes}
        return own | {each.name for each in self.vocabularies if own & set(each.extends)}

    @cached_property
    def _owners(self) -> Mapping[type[Entry], Sequence[str]]:
        """Names of the vocabularies that have a kind."""
        found: dict[type[Entry], list[str]] = {}
        for vocabulary in self.vocabularies:
            for section in SECTIONS:
                for spec in vocabulary.specs(section):
                    found.setdefault(spec, []).append(vocabulary.name)
        return found

    def _first(self, vocabulary: Vocabulary, section: str) -> list[type[Entry]]:
        """The kinds of a vocabulary, but shared ones that one before it has."""
        before = self.vocabularies[: self.vocabularies.index(vocabulary)]
        known = {spec for each in before for spec in each.specs(section) if spec.shared}
        return [spec for spec in vocabulary.specs(section) if spec not in known]


@lru_cache
def _scene_class(grammar: Grammar, required: frozenset[str] = REQUIRED) -> type[Scene]:
    sections: dict[str, Any] = {} if required else {"scene": (str, "")}
    for section in SECTIONS:
        union, given = _union(grammar, section), section in required
        means = SECTIONS_MEAN[section]
        field = Field(min_length=1, description=means) if given else Field(default_factory=dict, description=means)
        sections[section] = (Mapping[Name, union], field)  # type: ignore[valid-type]  # made at run time
    study = study_spec_class(
        grammar.engines, tuple(vocabulary.options for vocabulary in grammar.vocabularies if vocabulary.options)
    )
    sections["study"] = (study, Field(default_factory=study, description="number of builds, and their draws"))
    column: Any = published_column_class(
        tuple(vocabulary.published for vocabulary in grammar.vocabularies if vocabulary.published)
    )
    sections["published"] = (Mapping[Name, column], Field(default_factory=dict, description=PUBLISHED_MEANS))
    made = create_model("Scene", __base__=Scene, __module__=Scene.__module__, __doc__=Scene.__doc__, **sections)
    made.grammar, made.laws = grammar, grammar.laws
    return made


def _said_of(word: object, pairs: Iterable[tuple[tuple[str, str], ...]]) -> str:
    return next((advice for pair in pairs for other, advice in pair if other == word), "")


def _refuse_ambiguity(expected: str, owners: Mapping[str, str], words: Mapping[str, Sequence[str]]) -> None:
    """Refuse a word of two vocabularies, or one that others own already."""
    first = dict(owners)
    for vocabulary, own in words.items():
        for word in own:
            if word in first:
                raise InputError(f"{vocabulary}: expected {expected}, got {word!r}, which {first[word]} registers")
            first[word] = vocabulary


def _union(grammar: Grammar, section: str) -> Any:
    """One of the section's kinds, discriminated by the word."""
    specs = tuple(grammar.kinds(section).values())
    return specs[0] if len(specs) == 1 else Annotated[Union[specs], Field(discriminator="kind")]  # noqa: UP007


def specs_in(place: ModuleType) -> tuple[type[Any], ...]:
    """Every kind that a module defines, or the modules of a package in the order of their names."""
    found = pkgutil.iter_modules(getattr(place, "__path__", ()))
    modules = [place, *(import_module(f"{place.__name__}.{each.name}") for each in found)]
    defined = ((module.__name__, value) for module in modules for value in vars(module).values())
    return tuple(
        value
        for module, value in defined
        if isinstance(value, type) and issubclass(value, Entry) and value.__module__ == module and kind_of(value)
    )
