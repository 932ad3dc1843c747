"""A scene from STEP files: parts, their drawings, moves and measures, as a text that a person edits.

A drafted scene checked as `tol3d check` does, so that it runs as it is written.
"""

import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, Protocol

import numpy as np

from tol3d.apps.drafting.drawing import source
from tol3d.apps.drafting.entry import LAW as LAW_HERE
from tol3d.apps.drafting.entry import Entry, Scene, Wording
from tol3d.apps.drafting.features import faces_of
from tol3d.apps.drafting.fixture import fixture
from tol3d.apps.drafting.measured import MOST_MEASURES, Candidate, Key, apart, between, ranked
from tol3d.apps.drafting.other_files import name_of, roots, with_other_files
from tol3d.apps.drafting.parts import DraftedPart, ReadText, drafted_parts, read_files, seated
from tol3d.apps.drafting.touching_faces import ALONE, FIRST, Contacts, moves, size_of
from tol3d.apps.drafting.words import Names, cleaned, comment, length, scalar
from tol3d.cad.step import FoundFeature, StepError, shown
from tol3d.errors import InputError, SceneError
from tol3d.files import FileContent
from tol3d.scene import hint
from tol3d.simulate import Overrides, load, simulation_of
from tol3d.study import drawn

LAW: Final = "{kind: normal}"
GUESS: Final = 0.1  # mm; zones where no file states any
PER_PLAY: Final = 4.0  # guessed zones of a pair of pins in their holes: together they take half the play
MOST_TRIES: Final = 200
TRIALS: Final = 10_000
LONGEST: Final = 240  # characters of a reason
MOST_NAMED: Final = 6  # parts in a note
MOST_LISTED: Final = 12  # of what a scene lacks of the shapes
SAMPLE: Final = 256  # trials by which measures are ranked


@dataclass(frozen=True)
class Seat:
    """Seat of a face of a part on one of another: `cover.A` on `base.D`."""

    seat: str
    on: str


@dataclass(frozen=True)
class Draft:
    """A drafted scene and its sources.

    Args:
        files: as they were read.
        parts: of the scene.
        entries: in the order in which they are written; the parts are not among them.
        candidates: measures among which to choose; their entries are among the others.
        contacts: of several parts.
        missing: files in which parts stand and that cannot be read, with the reason.
    """

    files: Sequence[ReadText]
    parts: Sequence[DraftedPart]
    entries: Sequence[Entry]
    candidates: Sequence[Candidate] = ()
    contacts: Contacts | None = None
    missing: Mapping[str, str] = field(default_factory=dict)

    def scene(self) -> tuple[str, dict[int, Entry]]:
        """The text, and the entry of each line of it."""
        body = [part.entry() for part in self.parts]
        return Scene(self.head(), LAW, [*body, *self.entries], [*self.tail()]).written()

    def head(self) -> list[str]:
        """Heading of the scene."""
        files = [shown(name) for name in roots({own.name: own.file for own in self.files})]
        name = cleaned(" and ".join(file.rpartition(".")[0] or file for file in files), "/\\:") or "from STEP"
        return [
            f"# Drafted by tol3d new --from {comment(' '.join(files))}; yours to edit. What the files do not say is",
            "# marked `guess`; what of them the scene lacks is listed at its end. `tol3d check` says what it means.",
            f"scene: {scalar(name)}",
        ]

    def tail(self) -> Iterator[str]:
        """The study, and the losses and omissions of the files, so that counts add up."""
        yield from ("", f"study: {{trials: {TRIALS}, seed: 1}}")
        for file in self.files:
            yield from self.told(file)
        yield from listed("Parts in other files that are not in the scene:", self.parts_left())
        yield from listed("Found on the parts, and not in the scene:", self.features_left())
        yield from listed("Pins in holes and slots that no move uses:", self.pairs_left())
        threads = [(part.name, each) for part in self.parts if not part.like for each in part.features.part.threads]
        yield from listed(
            "Threads by name, whose faces are plain cylinders here:",
            [f"{comment(own)}: {each}" for own, each in threads],
        )

    def parts_left(self) -> Iterator[str]:
        """Parts whose files are missing."""
        for read_text in self.files:
            for own in read_text.file.elsewhere:
                if (name := name_of(own.file, read_text.name)) in self.missing:
                    yield f"{comment(own.use.path)}: {comment(name)}: {comment(self.missing[name])}"

    def features_left(self) -> Iterator[str]:
        """Counterbores, countersinks, slots, tabs and patterns of which the scene has no surface."""
        for part in self.parts:
            groups = part.features.groups
            used = {own.faces for group in groups for own in (*group.members, *group.slot)}
            left = [
                own for own in (() if part.like else part.features.part.machined.all)
                if not used & {member.faces for member in own.members}
            ]  # fmt: skip
            for words in dict.fromkeys(own.words for own in left):
                alike = [own for own in left if own.words == words]
                count = f"{len(alike)} × " if len(alike) > 1 else ""
                yield f"{comment(part.name)}: {count}{words}, {faces_of(alike[0].members[0])}"

    def pairs_left(self) -> Iterator[str]:
        """Pins in holes or slots of other parts that lie in no line of a move."""
        moves = [entry.wording.lines for entry in self.entries if entry.section == "moves" and entry.stands]
        lines = [line for own in moves for line in own]
        for pair in self.contacts.pins if self.contacts is not None else ():
            of = [part.of(name) if (name := part.features.name_of(own)) else "" for part, own in pair.ends]
            if not all(of) or not any(all(f": {end}" in line for end in of) for line in lines):
                yield pair.words

    def notes(self) -> Iterator[str]:
        """Notes to read before the scene: counts, and parts that nothing places."""
        yield from self.parts_left()
        for line in self.tail():
            if line.startswith("# Of the "):
                yield line.removeprefix("# ")
        for why in (ALONE, FIRST):
            fixed = [
                entry.wording.lines[0].partition("part: ")[2].removesuffix("}")
                for entry in self.entries
                if entry.section == "moves" and entry.stands and why in entry.wording.comment
            ]
            if fixed:
                more = f" and {len(fixed) - MOST_NAMED} more" if len(fixed) > MOST_NAMED else ""
                names = ", ".join(fixed[:MOST_NAMED]) + more
                yield f"{names}: {why}, fixed there; --seat PART.FACE --on PART.FACE lays one on another"

    def told(self, own: ReadText) -> Iterator[str]:
        """Outcome of each tolerance and dimension of a file, in comments."""
        drawings = [part.drawing for part in self.parts if not part.like and part.file is own.file]
        reasons = {key: why for drawing in drawings for key, why in drawing.reasons.items()}
        doubled = {key: why for drawing in drawings for key, why in drawing.doubled.items()}
        lost: list[str] = []
        left: list[str] = []
        for tolerance, meaning in zip(own.text.tolerances, own.meanings.all, strict=True):
            made = [entry for entry in self.entries if tolerance.id in (entry.source, *entry.below)]
            standing = [each for each in made if each.stands]
            words = [doubled.get(tolerance.id, ""), *(word for each in standing for word in each.losses)]
            why = "; ".join(dict.fromkeys(filter(None, words)))
            if not standing:
                refused = next((each.refused for each in made if each.refused), "")
                reason = refused or reasons.get(tolerance.id) or meaning.why or "its part is not in the scene"
                left.append(f"{source(tolerance)}: {comment(reason, LONGEST)}")
            elif meaning.why or why:
                lost.append(f"{source(tolerance)}: {comment('; '.join(filter(None, (meaning.why, why))), LONGEST)}")
        left += unread(own, "tolerance")
        count = len(own.text.tolerances) + len(unread(own, "tolerance"))
        said = count - len(lost) - len(left)
        name = comment(own.name)
        if count:
            yield from ("", f"# Of the {count} tolerances in {name} {said} are said, {len(lost)} approximately, "
                        f"{len(left)} left out.")  # fmt: skip
        for heading, listed in (("Approximately:", lost), ("Left out:", left)):
            if listed:
                yield f"# {heading}"
                yield from (f"#   {line}" for line in listed)
        yield from self.targets_told(own)
        yield from self.dimensions_told(own, reasons)
        if own.text.remarks:
            yield f"# {len(own.text.remarks)} remarks on what was not read or is incomplete: tol3d pmi lists them."

    def targets_told(self, own: ReadText) -> Iterator[str]:
        """Datum targets of a file whose places it does not give, each with a line to fill in."""
        asked = [datum for datum in own.text.datums if datum.targets and datum.id not in own.meanings.datum_features]
        if not asked:
            return
        yield "# The file does not say where these datum targets are. Fill in points of the part [mm] for each ?, and"
        yield "# write the line in `datums` of the tolerances to it; its feature is the face that they are on:"
        for datum in asked:
            letter = comment(datum.letter)
            named = ", ".join(f"{letter}{comment(target.number)} {comment(target.kind)}" for target in datum.targets)
            places = ", ".join("[? mm, ? mm, ? mm]" for _ in datum.targets)
            yield f"#   - {{feature: {letter}, simulator: targets, targets: [{places}]}}  # {named}"

    def dimensions_told(self, own: ReadText, reasons: dict[int, str]) -> Iterator[str]:
        """Outcome of each dimension of a file."""
        said = {entry.source for entry in self.entries if entry.source is not None and entry.stands}
        left = []
        for dimension in own.text.dimensions:
            if dimension.id in said:
                continue
            refused = next(
                (entry.refused for entry in self.entries if entry.source == dimension.id and entry.refused), ""
            )
            why = (
                refused
                or reasons.get(dimension.id)
                or (
                    "basic: the nominal shape says it"
                    if dimension.role == "basic"
                    else "for reference"
                    if dimension.role == "reference"
                    else "it states no limits"
                    if dimension.limits is None
                    else f"{comment(dimension.kind)} of what the scene does not use, or uses already"
                )
            )
            left.append(f"#   {comment(str(dimension))}: #{dimension.id}: {comment(why, LONGEST)}")
        left += [f"#   {line}" for line in unread(own, "dimension")]
        count = len(own.text.dimensions) + len(unread(own, "dimension"))
        if count:
            yield f"# Of its {count} dimensions {count - len(left)} are said, {len(left)} not:"
            yield from left


def listed(heading: str, lines: Iterable[str]) -> Iterator[str]:
    """A list in comments, cut after MOST_LISTED lines; nothing without lines."""
    every = list(lines)
    if every:
        yield f"# {heading}"
        yield from (f"#   {line}" for line in every[:MOST_LISTED])
    if len(every) > MOST_LISTED:
        yield f"#   and {len(every) - MOST_LISTED} more"


def unread(read_text: ReadText, what: str) -> list[str]:
    """The tolerances or dimensions of a file that cannot be read, each with the reason, for the list of omissions."""
    read = {tolerance.id for tolerance in read_text.text.tolerances} | {
        dimension.id for dimension in read_text.text.dimensions
    }
    lost = [remark for remark in read_text.text.remarks if remark.what == what and remark.id not in read]
    return [f"#{each.id}: {comment(each.why, LONGEST)}" for each in lost]


def draft(
    contents: Sequence[FileContent],
    seats: Sequence[Seat] = (),
    *,
    inspect: bool = False,
    chosen: Sequence[Key] | None = None,
) -> Draft:
    """A scene from STEP files, not yet checked.

    Args:
        contents: of the files.
        seats: faces on which parts are laid.
        inspect: whether each tolerance is measured against its own limit too.
        chosen: measures between parts that it has; None for all that there may be.

    Raises:
        InputError: a file cannot be read, or a seat is of no part or face.
    """
    named, missing = with_other_files(contents)
    files = read_files(named)
    names = Names()
    parts = list(drafted_parts(files, names))
    for part in parts:
        if not part.like:
            part.drawing.read()
    for seat in seats:
        part, face = found(parts, seat.seat, "--seat")
        other, there = found(parts, seat.on, "--on")
        if part is other:
            raise InputError(f"--on: expected a face of another part than {shown(seat.seat)!r}, got {shown(seat.on)!r}")
        seated(part, face, other, there)
    said = [entry for part in parts if not part.like for entry in part.drawing.entries]
    said = said if inspect else list(uninspected(said))
    contacts = Contacts(parts) if len(parts) > 1 else None
    if contacts is None:
        placed, candidates = fixture(parts[0], names), list(apart(parts[0], names, chosen))
    else:
        placed = list(moves(contacts, names))
        candidates = list(between(contacts, names, chosen))
    if chosen is not None:
        candidates.sort(key=lambda own: chosen.index(own.key))
    made = [*said, *placed, *(own.entry for own in candidates)]
    made += something(parts, made, names, contacts)
    made += () if said else guessed(parts, names)
    return Draft(files, parts, sorted(made, key=is_inspection), candidates, contacts, missing)


def uninspected(entries: Sequence[Entry]) -> Iterator[Entry]:
    """Entries without the measures of tolerances that are simulated: their zones hold by construction.

    Of a tolerance that is inspected only, one measure is left.
    """
    told: set[int | None] = set()
    for entry in entries:
        if entry.inspects is None or (not entry.needs and entry.inspects not in told):
            yield entry
            told.add(entry.inspects)


def is_inspection(entry: Entry) -> bool:
    """True if an entry is the measure of a frame's own limit: those come last, there are many of them."""
    return entry.section == "measures" and "kind: inspected" in entry.wording.lines[0]


def guessed(parts: Sequence[DraftedPart], names: Names) -> Iterator[Entry]:
    """Zones of all named features, if no file states a tolerance: a list of contributors to begin with."""
    for part in parts:
        for group in () if part.like else part.features.groups:
            flat = group.kind == "plane"
            width = float(f"{min(GUESS, part.features.play.get(group.name, GUESS) / PER_PLAY):.2g}")
            zone = f"{{{'width' if flat or group.kind == 'slot' else 'diameter'}: {length(width)}}}"
            kind = "profile" if flat else "position"
            words = f"{{kind: {kind}, of: {part.of(group.name)}, zone: {zone}, law: {LAW_HERE}}}"
            name = names.new(f"{part.name} {group.name}", kind, len(group.members))
            yield Entry("tolerances", scalar(name), [Wording((words,), "guess: the files state no tolerance")])


def something(
    parts: Sequence[DraftedPart], entries: Sequence[Entry], names: Names, contacts: Contacts | None
) -> Iterator[Entry]:
    """A measure where there is none yet, and a feature of each part that has none: a scene has both.

    The measure is of a single part, or of the one that holds the others and the largest of these, one in contact first.

    Raises:
        StepError: a part has no face that a scene can use.
    """
    for part in parts:
        if not part.features.groups:
            part.features.name(part.features.largest()[0])
    if any(entry.section == "measures" for entry in entries):
        return
    first = last = parts[0]
    if contacts is not None:
        first = contacts.base
        last = max(
            (own for own in parts if own is not first), key=lambda own: (contacts.touch(first, own), size_of(own))
        )
    faces = first.features.largest()
    start = first.features.name(faces[0])
    end = last.features.name(faces[-1] if first is last else last.features.largest()[0])
    words = f"{{kind: distance, from: {first.of(start)}, to: {last.of(end)}}}"
    yield Entry("measures", scalar(names.new("distance", "distance")), [Wording((words,), "guess: name what counts")])


def found(parts: Sequence[DraftedPart], words: str, option: str) -> tuple[DraftedPart, FoundFeature]:
    """A face of a part, by the name of the part and a datum's letter, a feature's name, or the number of a face.

    Raises:
        InputError: there is none.
    """
    name, _, feature = words.rpartition(".")
    part = next((own for own in parts if own.name == name), None)
    if part is None:
        known = [own.name for own in parts]
        listed = ", ".join(map(repr, known[:8]))
        raise InputError(
            f"{option}: expected a part and a face of it, such as {known[0]}.A, got {shown(words)!r}"
            f"{hint(name, known)}; parts: {listed}"
        )
    wanted = part.drawing.datums.get(feature, feature)
    members = {n: m for group in part.features.groups for n, m in zip(group.names, group.members, strict=True)}
    number = int(feature[1:]) if feature.startswith("#") and feature[1:].isdecimal() else None
    own = members.get(wanted)
    if number is not None:
        own = next((each for each in part.features.part.features if number in each.faces), None)
    if own is None or own.kind != "plane":
        known = [n for n, m in members.items() if m.kind == "plane"]
        what = "no flat face" if own is not None else "none of its faces"
        raise InputError(
            f"{option}: expected a flat face of {name!r}, got {shown(feature)!r}, {what}; write one of "
            f'{", ".join(map(repr, known[:12])) or "its faces"}, or its number in the file, such as "{name}.#12"'
        )
    return part, own


class Drafted(Protocol):
    """A drafted scene of whatever files."""

    def scene(self) -> tuple[str, Mapping[int, Entry]]:
        """The text, and by its lines the entries that may be written otherwise or left out."""

    def notes(self) -> Iterator[str]:
        """Notes to read before the scene."""


def settled(drafted: Drafted, check: Callable[[str], None]) -> str:
    """The text of a drafted scene that a check accepts: refused entries are written otherwise, or left out.

    Args:
        drafted: the scene.
        check: raises SceneError with messages that begin with file and line.

    Raises:
        SceneError: something else than an entry is refused.
    """
    for _ in range(MOST_TRIES):
        text, by_line = drafted.scene()
        try:
            check(text)
        except SceneError as error:
            blamed = list(blame(error.problems, by_line))
            if not blamed:
                raise
            for entry, why in blamed:
                entry.worsen(why)
            continue
        return text
    raise StepError("no scene that can be checked comes of these files")


def blame(problems: Sequence[str], by_line: Mapping[int, Entry]) -> Iterator[tuple[Entry, str]]:
    """The entries that messages are about, each once; the one that refines another rather than that."""
    told: set[int] = set()
    for problem in problems:
        entry = entry_of(problem, by_line)
        if entry is None or entry.section == "parts":
            continue
        words = problem.partition(": ")[2]
        refining = problem.partition("of '")[2].partition("', which refines it")
        if refining[1]:
            other = next((own for own in by_line.values() if own.name in (refining[0], scalar(refining[0]))), None)
            entry = other or entry
        if id(entry) not in told:
            told.add(id(entry))
            yield entry, words


def entry_of(problem: str, by_line: Mapping[int, Entry]) -> Entry | None:
    """The entry on whose line a message is, else the one that it names."""
    place = problem.split(": ", 1)[0].rpartition(":")[2]
    if place.isdecimal() and int(place) in by_line:
        return by_line[int(place)]
    named = [own for own in dict.fromkeys(by_line.values()) if f"{own.section}.{own.name.strip(chr(34))}" in problem]
    return named[0] if named else None


SCENE = "scene.yaml"


def scene_from(
    contents: Sequence[FileContent],
    seats: Sequence[Seat] = (),
    *,
    inspect: bool = False,
    tell: Callable[[str], None] = lambda words: None,
) -> tuple[str, Draft]:
    """A scene from STEP files that `tol3d check` accepts and `tol3d run` runs, and its draft.

    Args:
        contents: of the files.
        seats: faces on which parts are laid.
        inspect: whether each tolerance is measured against its own limit too.
        tell: progress callback, with words.

    Raises:
        InputError: a file cannot be read, or a seat is of no part or face.
    """
    drafted = draft(contents, seats, inspect=inspect)
    tell(f"checking {len(drafted.parts)} parts with {len(drafted.entries)} entries")
    with tempfile.TemporaryDirectory(prefix="tol3d-new-") as made:
        folder = Path(made)
        for file in drafted.files:
            path = folder / file.name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(file.file.content.content)

        def check(text: str) -> None:
            (folder / SCENE).write_text(text, encoding="utf-8")
            simulation_of(load(folder / SCENE), Overrides())

        text = settled(drafted, check)
        if drafted.candidates:
            others = [own for own in drafted.entries if own.section == "measures" and own.stands and not own.needs]
            tell(f"ranking {len(drafted.candidates)} measures")
            most = MOST_MEASURES - (len(others) - sum(own.entry.stands for own in drafted.candidates))
            chosen = ranked(drafted.candidates, deviations(folder / SCENE), max(most, 0))
            drafted = draft(contents, seats, inspect=inspect, chosen=chosen)
            text = settled(drafted, check)
        return text, drafted


def deviations(path: Path) -> dict[str, float]:
    """Standard deviation of each measure of a scene over SAMPLE trials by the analytic method [mm]."""
    simulation = simulation_of(load(path), Overrides())
    method = simulation.system.method("analytic", simulation.system.materials("analytic"))
    answers = method.answers(drawn(simulation, 0, SAMPLE), simulation.system.measures)
    return {name: float(np.std(values)) for name, values in answers.values.items()}
