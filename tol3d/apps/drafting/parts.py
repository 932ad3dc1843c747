"""The parts of a drafted scene: one of each use in each file, those of one product alike."""

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Final

import numpy as np

from tol3d.apps.drafting.drawing import Drawing
from tol3d.apps.drafting.entry import Entry, Wording
from tol3d.apps.drafting.features import Features
from tol3d.apps.drafting.other_files import name_of, roots
from tol3d.apps.drafting.words import Names, across, comment, direction, place, scalar
from tol3d.cad.step import (
    FoundFeature,
    Meanings,
    StepError,
    StepFile,
    StepText,
    Use,
    read_step,
    read_step_text,
    shown,
    surfaces_of,
)
from tol3d.files import FileContent
from tol3d.numerics.arrays import Array

STILL: Final = 1e-12
MOST_PARTS: Final = 200  # of one scene that a person reads
MOST_NAMED: Final = 6  # files in a message
MOST_SIGNS: Final = 24  # of a part's name that a person types
MOST_WORDS: Final = 2  # of it, beside a number
STANDARDS: Final = frozenset(("AN", "ANSI", "AS", "ASME", "DIN", "EN", "GB", "ISO", "JIS", "MS", "NAS"))
"""Short names of standards, whose numbers stand behind them in names of bolts and bearings."""
TOKEN: Final = re.compile(r"[^\s_.,;()/\\-]+")
QUALIFIED: Final = re.compile(r"(?<=\w)(?:\s*[,;(]|\s(?:of|for|with|from)\s)")
"""Begin of what only qualifies a name."""
NUMBER: Final = re.compile(r"[0-9]{1,3}")


@dataclass
class DraftedPart:
    """A part of a drafted scene.

    Args:
        name: in the scene.
        file: that it is from.
        file_name: that of the file in the scene.
        selection: how the scene names it in its file, as YAML; "" where that has only one.
        pose: in the world (4, 4) [mm].
        by_file: True if the file states it, False if the scene does.
        features: of its product; parts that are alike share them.
        drawing: of its product; parts that are alike share it.
        like: the first part of its product.
        guess: reason for its pose; "" if the file states it.
    """

    name: str
    file: StepFile
    file_name: str
    selection: str
    pose: Array
    by_file: bool
    features: Features
    drawing: Drawing
    like: str = ""
    guess: str = ""

    def at(self, feature: FoundFeature) -> Array:
        """The middle of a feature in the world (3,) [mm]."""
        return np.asarray(self.pose[:3, :3] @ np.array(feature.at) + self.pose[:3, 3])

    def along(self, local: Sequence[float]) -> Array:
        """A direction in the world (3,)."""
        return np.asarray(self.pose[:3, :3] @ np.array(local))

    def of(self, feature: str) -> str:
        """A feature with the part, as YAML."""
        return scalar(f"{self.name}.{feature}")

    def first_of(self, feature: str) -> str:
        """A feature with the first part of the product, whose tolerances are those of the others too, as YAML."""
        return scalar(f"{self.like or self.name}.{feature}")

    def entry(self) -> Entry:
        """The part as an entry, with the features that are selected by now."""
        lines = ["kind: step", f"file: {scalar(self.file_name)}"]
        if self.selection:
            lines.append(self.selection)
        if self.like:
            lines.append(f"like: {scalar(self.like)}")
        elif self.features.groups:
            lines.append("features:")
            for group in self.features.groups:
                remark = f"  # {group.comment}" if group.comment else ""
                lines.append(f"  {scalar(group.name)}: {group.line}{remark}")
        if not self.by_file and not np.allclose(self.pose, np.eye(4), atol=STILL):
            z, x = self.pose[:3, 2], self.pose[:3, 0]
            remark = f"  # guess: {self.guess}" if self.guess else ""
            where = f"{{at: {place(self.pose[:3, 3])}, z: {direction(z)}, x: {direction(x)}}}"
            lines.append(f"placed: {where}{remark}")
        product = self.features.part.name
        told = f"{comment(product)}, #{self.features.part.body.product}"
        return Entry("parts", scalar(self.name), [Wording(tuple(lines), told)])


@dataclass(frozen=True)
class ReadText:
    """A file with its text, and the name that the scene gives it."""

    name: str
    file: StepFile
    text: StepText
    meanings: Meanings


def read_files(contents: Mapping[str, FileContent]) -> tuple[ReadText, ...]:
    """Files as they are read, text and geometry, by the names that the scene gives them.

    Raises:
        StepError: one cannot be read.
    """
    found = []
    for name, content in contents.items():
        text = read_step_text(content.content, content.path.name)
        found.append(ReadText(name, read_step(content), text, Meanings(text, surfaces_of(text))))
    return tuple(found)


@dataclass(frozen=True)
class Standing:
    """A part as it stands in the scene.

    Args:
        file: that has its shape.
        use: in that file.
        pose: in the world (4, 4) [mm].
        by_file: True if that file states the pose.
        called: name of its product in the assembly that refers to that file, if it is the only part there; else "".
    """

    file: ReadText
    use: Use
    pose: Array
    by_file: bool
    called: str = ""


def standing(files: Sequence[ReadText]) -> Iterator[Standing]:
    """Each part of the files that no other refers to, with those of the files that these refer to.

    Raises:
        StepError: there are too many.
    """
    by_name = {own.name: own for own in files}
    waiting = [(by_name[name], np.eye(4), "", True) for name in roots({own.name: own.file for own in files})]
    count = 0
    while waiting:
        read_text, pose, called, top = waiting.pop(0)
        single = len(read_text.file.uses) == 1 and not read_text.file.elsewhere
        for use in read_text.file.uses:
            own_pose = pose if single else pose @ posed(use)
            yield Standing(read_text, use, own_pose, top and not single, called if single else "")
        waiting[:0] = [
            (by_name[name], pose @ posed(own.use), own.name, False)
            for own in read_text.file.elsewhere
            if (name := name_of(own.file, read_text.name)) in by_name
        ]
        count += max(1, len(read_text.file.uses))  # empty assemblies may be used often too
        if count + len(waiting) > MOST_PARTS:
            raise StepError(f"expected at most {MOST_PARTS} parts in a scene, got {count + len(waiting)}")


def drafted_parts(files: Sequence[ReadText], names: Names) -> Iterator[DraftedPart]:
    """A part of each use in each file; their drawings are not read yet.

    Raises:
        StepError: there are too many, or none.
    """
    every = list(standing(files))
    if not every:
        lacking = ", ".join(sorted({shown(each.file) for own in files for each in own.file.elsewhere})[:MOST_NAMED])
        raise StepError(f"{files[0].file.name}: its parts stand in files that are not in its folder: {lacking}")
    first: dict[tuple[str, int], DraftedPart] = {}
    for own, wish in zip(every, names_of(every), strict=True):
        key = own.file.name, own.use.product
        made = drafted_part(own, names.new(wish, "part"), names, first.get(key))
        first.setdefault(key, made)
        yield made


def names_of(every: Sequence[Standing]) -> Iterator[str]:
    """A short name of each part; those of one name, be they of one product or of several, are numbered."""
    words = {own.file.name: use_words(own.file.file) for own in every}
    names = [shortened(own.called or words[own.file.name][own.use.path]) for own in every]
    alike, counts = Counter(names), Counter[str]()
    for name in names:
        counts[name] += 1
        yield name if alike[name] == 1 else f"{name} {counts[name]}"


def use_words(file: StepFile) -> dict[str, str]:
    """Name of each use in a file, by its path: its own if those of its product differ, else the product's."""
    named: dict[str, str] = {}
    for part in file.parts:
        uses = [use.path for use in file.uses if use.product == part.body.product]
        own = [path.rpartition("/")[2] for path in uses]
        counted = re.compile(re.escape(part.body.name) + r"(?:_[0-9]+)?")  # numbered for want of names
        told = len({*own}) == len(own) > 1 and not all(map(counted.fullmatch, own))
        named |= {path: word if told else part.name for path, word in zip(uses, own, strict=True)}
    return named


def shortened(text: str) -> str:
    """A name of at most MOST_WORDS words and MOST_SIGNS that a person types.

    Longer ones lose what stands behind a comma or a preposition, and codes such as numbers of parts and of standards;
    of the first words left the last stay, for they name the part, and so does a number at the end.

    >>> shortened("L-BRACKET"), shortened("92196A196_18-8 Stainless Steel Head Screw"), shortened("a-pillow-block 2")
    ('L-BRACKET', 'Head Screw', 'pillow-block 2')
    """
    whole = text.replace(".", " ").strip()
    tokens = list(TOKEN.finditer(whole))
    words = [own for own in tokens if not is_code(own[0])]
    if len(whole) <= MOST_SIGNS and len(words) <= MOST_WORDS:
        return whole
    head = QUALIFIED.split(whole, maxsplit=1)[0]
    runs = [list(run) for coded, run in groupby(TOKEN.finditer(head), lambda own: is_code(own[0])) if not coded]
    if not runs:
        return whole[:MOST_SIGNS].rstrip(" _-")
    number = f" {tokens[-1][0]}" if NUMBER.fullmatch(tokens[-1][0]) else ""
    last = runs[0][-MOST_WORDS:]
    starts = [own.start() for own in last if last[-1].end() - own.start() + len(number) <= MOST_SIGNS]
    start = starts[0] if starts else last[-1].start()
    return head[start : last[-1].end()][: MOST_SIGNS - len(number)] + number


def is_code(token: str) -> bool:
    """True if a token of a name is no word: it has digits, or is a standard."""
    return token in STANDARDS or any(sign.isdecimal() for sign in token)


def drafted_part(own: Standing, name: str, names: Names, like: DraftedPart | None) -> DraftedPart:
    """The part of one use."""
    read_text = own.file
    part = next(each for each in read_text.file.parts if each.body.product == own.use.product)
    single = len(read_text.file.uses) == 1
    features = like.features if like is not None else Features(part)
    selection = "" if single else f"use: {scalar(own.use.path)}"
    if single and len(read_text.file.parts) > 1:
        selection = f"product: {scalar(part.name)}"
    drawing = like.drawing if like is not None else Drawing(read_text.text, read_text.meanings, name, features, names)
    like_name = "" if like is None else like.name
    return DraftedPart(
        name, read_text.file, read_text.name, selection, own.pose, own.by_file, features, drawing, like_name
    )


def posed(use: Use) -> Array:
    """Pose of a use (4, 4) [mm]."""
    at, z, x = use.frame
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2], pose[:3, 3] = x, np.cross(z, x), z, at
    return pose


def seated(part: DraftedPart, seat: FoundFeature, on: DraftedPart, target: FoundFeature) -> None:
    """Place a part with a face of it on a face of another, middle on middle, with the least turn."""
    normal, wanted = part.along(seat.direction), -on.along(target.direction)
    turn = least_turn(normal, wanted)
    part.pose[:3, :3] = turn @ part.pose[:3, :3]
    part.pose[:3, 3] = on.at(target) - part.pose[:3, :3] @ np.array(seat.at)
    part.by_file = False
    part.guess = "the middle of one face on that of the other"


def least_turn(start: Array, end: Array) -> Array:
    """The least rotation that brings one direction to another (3, 3)."""
    axis = np.cross(start, end)
    sine, cosine = float(np.linalg.norm(axis)), float(start @ end)
    if sine < STILL:
        if cosine > 0.0:
            return np.eye(3)
        axis, sine, cosine = np.array(across(start)[0]), 0.0, -1.0
    axis = axis / np.linalg.norm(axis)
    cross = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    return np.asarray(np.eye(3) + sine * cross + (1.0 - cosine) * (cross @ cross))
