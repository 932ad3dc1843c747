"""Names across a scene: each given once, each use of one existing and of the right sort."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from stat import S_ISREG

from tol3d.errors import InputError, SceneError
from tol3d.scene.bases import ToleranceSpec, laws_in
from tol3d.scene.entry import Entry, Reference, Unusable
from tol3d.scene.nearest import hint
from tol3d.scene.place import KeyPath
from tol3d.scene.problems import first_few
from tol3d.scene.published import PublishedFigures
from tol3d.scene.published.figures import quantities_in
from tol3d.scene.published.whole import PublishedWhole
from tol3d.scene.schema import SECTIONS, Scene
from tol3d.statistics.distributions.unsized import SIZE, STANDARDS, UnsizedSpec
from tol3d.units import expectation, shown

Refusal = tuple[KeyPath, str]
"""Place of what cannot be, and the sentence that says why."""


def refuse(scene: Scene, problems: list[Refusal]) -> None:
    """Raise if there are problems.

    Raises:
        SceneError: with the first few of them, in the order of the file.
    """
    if problems:
        ordered = sorted(problems, key=lambda problem: scene.origin.order(problem[0]))
        raise SceneError(*first_few([scene.origin.message(path, sentence) for path, sentence in ordered]))


def loose_ends(scene: Scene) -> list[Refusal]:
    """Inconsistencies in a scene that is right field by field: names first, then their meaning."""
    problems = bad_names(scene)
    if not problems:
        contradicted = list(_contradicted(scene))
        leading = [problem for problem, leads in contradicted if leads]
        problems = leading or [
            *scene.grammar.problems(scene),
            *(problem for problem, _ in contradicted),
            *_unsized(scene),
        ]
    return [*problems, *_unpublished(scene), *_unstoppable(scene)]


def bad_names(scene: Scene) -> list[Refusal]:
    """Names that stand twice; if there are none, those that entries use and that are not there."""
    return list(_repeated(scene)) or list(_unknown(scene))


def unreadable_files(scene: Scene, trust_parts: bool) -> list[Refusal]:
    """Files of a scene that are not there, or lie outside its folder without being trusted."""
    return [
        ((*path, *field), sentence)
        for path, entry in scene.entries().items()
        for field, file in entry.file_names()
        if (sentence := _file_problem(scene.folder, file, trust_parts))
    ]


def _repeated(scene: Scene) -> Iterator[Refusal]:
    first: dict[str, KeyPath] = {}
    for section in SECTIONS:
        for name in scene.section(section):
            here: KeyPath = (section, name)
            if name in first:
                there = f"{first[name][0]} (line {scene.place(first[name]).line})"
                yield here, f"expected a name of its own, got {name!r}, which already stands in {there}; rename one"
            else:
                first[name] = here


def _references(scene: Scene) -> Iterator[tuple[KeyPath, Reference]]:
    for path, entry in scene.entries().items():
        for reference in entry.references():
            yield (*path, *reference.path), reference


def _unknown(scene: Scene) -> Iterator[Refusal]:
    entries = scene.of(Entry)
    unusable: dict[type[Reference], Mapping[str, Unusable]] = {}
    for path, reference in _references(scene):
        if type(reference) not in unusable:
            unusable[type(reference)] = reference.unusable(scene.parts)
        unfit = unusable[type(reference)]
        if isinstance(entries.get(reference.name), reference.specs) and reference.name not in unfit:
            continue
        fitting = [name for name, entry in entries.items() if isinstance(entry, reference.specs) and name not in unfit]
        got = repr(reference.name)
        if reference.name in unfit:
            fitting = [unfit[reference.name].instead]
            got = f"{got}, {unfit[reference.name].why}"
        else:
            got = f"{got}, which {_found(scene, reference.name)}"
        advice = "" if reference.name in unfit else reference.advice(scene.parts, scene.moves)
        yield path, f"expected the name of {reference.expected}, got {got}{hint(reference.name, fitting)}{advice}"


def _found(scene: Scene, name: str) -> str:
    """Place and kind of a name in the scene, in words."""
    section = next((section for section in SECTIONS if name in scene.section(section)), None)
    if section is None:
        return "is not in the scene"
    words = scene.section(section)[name].words
    return f"is {words}" if words else f"stands in {section}"


def _contradicted(scene: Scene) -> Iterator[tuple[Refusal, bool]]:
    """Conflicts between entries, each with whether more may follow from it."""
    for (section, name), entry in scene.entries().items():
        for it in entry.contradictions(scene.parts, scene.moves):
            near = hint(it.got.strip("'"), it.known)
            yield ((section, name, *it.path), f"expected {it.expected}, got {it.got}{near}"), it.leads


def _unsized(scene: Scene) -> Iterator[Refusal]:
    """Classes of a standard on what it does not cover."""
    for path, entry in scene.entries().items():
        for law in laws_in(entry):
            if not isinstance(law, UnsizedSpec):
                continue
            sentence, place = f"expected {STANDARDS[law.standard].of}, got another deviation", path
            if isinstance(entry, ToleranceSpec) and law is entry.distribution:
                place = (*path, "distribution", *(() if law.standard == SIZE else (law.standard,)))
                try:
                    size = entry.size(law.standard, scene.parts, scene.moves)
                    sentence = sentence if size is None else law.refusal(size)
                except InputError as error:
                    sentence = str(error)
            yield place, sentence


def _unpublished(scene: Scene) -> Iterator[Refusal]:
    """Measures and contributors of published columns that the scene does not have."""
    for column, measures in scene.published.items():
        for name, values in measures.items():
            path: KeyPath = ("published", column, name)
            measure = scene.measures.get(name)
            if measure is None:
                known = [*scene.measures, *measures.keys_of_the_whole()]
                yield path, f"expected the name of a measure, got {name!r}{hint(name, known)}"
                continue
            for field, quantity in quantities_in(values):
                if quantity.dimension != measure.dimension:
                    expected = f"{expectation(measure.dimension)} ({name!r} is of kind {measure.kind})"
                    yield (*path, *field), f"expected {expected}, got {str(quantity)!r}"
            if values.curve and not measure.gives_curve:
                yield (*path, "curve"), f"expected none, for {name!r} has one value a trial, got a curve"
            for contributor in values.contributors:
                if contributor not in scene.tolerances:
                    near = hint(contributor, scene.tolerances)
                    yield (
                        (*path, "contributors", contributor),
                        f"expected the name of a tolerance, got {contributor!r}{near}",
                    )
        kinds: tuple[type[PublishedFigures], ...] = (PublishedWhole, *measures.sections)
        for sections in kinds:
            for place, sentence in sections.problems(measures, scene):  # type: ignore[arg-type]  # it is of all of them
                yield ("published", column, *place), sentence


def _unstoppable(scene: Scene) -> Iterator[Refusal]:
    """Conditions of an automatic study that no measure of the scene will reach."""
    for name, errors in scene.study.until.items():
        path: KeyPath = ("study", "until", name)
        measure = scene.measures.get(name)
        if measure is None:
            yield path, f"expected the name of a measure, got {name!r}{hint(name, scene.measures)}"
            continue
        if measure.gives_curve:
            yield path, f"expected a measure of one value a trial, got {name!r}, which takes a curve"
        for field, quantity in errors.quantities().items():
            if quantity.dimension != measure.dimension:
                expected = f"{expectation(measure.dimension)} ({name!r} is of kind {measure.kind})"
                yield (*path, field), f"expected {expected}, got {str(quantity)!r}"


def _file_problem(folder: Path, file: str, trust_parts: bool) -> str:
    """Reason why the file cannot be read, or nothing."""
    try:
        path = (folder / file).resolve()
        inside = path.is_relative_to(folder.resolve())
        if not inside and not trust_parts:
            return (
                f"expected a file in the scene's own folder, got {shown(file)}, which lies outside; "
                "copy it there, or say --trust-parts if you trust the scene"
            )
        mode = path.stat().st_mode
    except FileNotFoundError:
        return f"expected a file, got {shown(file)}, which is not there{_near(folder, file)}"
    except (OSError, RuntimeError, ValueError) as error:  # RuntimeError: a ring of links; ValueError: a NUL
        return f"expected a file that can be read, got {shown(file)}: {getattr(error, 'strerror', None) or error}"
    return "" if S_ISREG(mode) else f"expected a file, got {shown(file)}, which is a folder or a device"


def _near(folder: Path, file: str) -> str:
    suffix = Path(file).suffix
    try:
        return hint(file, sorted(entry.name for entry in folder.iterdir() if entry.suffix == suffix))
    except OSError:
        return ""
