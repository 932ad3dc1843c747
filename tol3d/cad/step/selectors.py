"""Features of a foreign part that a selector means: exactly one, exactly as many as it counts, or none at all."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from tol3d.cad.step.face_mesh import FaceMesh
from tol3d.cad.step.found_features import FeatureKind, FoundFeature, Triple, by_place
from tol3d.cad.step.outline import Named
from tol3d.cad.step.reading import StepPart
from tol3d.cad.step.refused import StepError, shown
from tol3d.numerics.arrays import Array
from tol3d.scene.nearest import hint

SAME_SIZE: Final = 1e-4
"""mm; a diameter that differs by more is another one."""
SAME_DISTANCE: Final = 1e-6
"""mm; features whose distances from a point differ by less are as near as each other."""
TWICE: Final = 2.0
"""Least ratio of the distances of the next and of the nearest feature, for a point to select one."""
SAME_VALUE: Final = 1e-6
"""mm; a tolerance whose value differs by more is another one."""
MOST_SHOWN: Final = 6
MOST_KNOWN: Final = 12


@dataclass(frozen=True)
class Selector:
    """Selector of features of a part; fields that are not stated do not matter.

    Args:
        face: the number of a face in the file; the whole feature that it is of.
        name: of a face in the file.
        datum: its letter.
        pmi: the name that the file gives a tolerance or dimension of it.
        tolerance: the kind of a tolerance of it, such as "position".
        value: of that tolerance [mm].
        datums: the letters of that tolerance's datums, such as "A | B-C".
        faces: numbers of faces that together are the feature, and no others.
        kind: of the feature.
        diameter: of a round one [mm].
        near: a point [mm] that is nearest to it.
        within: largest distance from that [mm].
        count: number of features.
        along: direction of x on a plane.
    """

    face: int | None = None
    name: str | None = None
    datum: str | None = None
    pmi: str | None = None
    tolerance: str | None = None
    value: float | None = None
    datums: str | None = None
    faces: tuple[int, ...] = ()
    kind: FeatureKind | None = None
    diameter: float | None = None
    near: Triple | None = None
    within: float | None = None
    count: int | None = None
    along: Triple | None = None


class SelectionError(StepError):
    """A selector means no feature, or another number of them.

    Args:
        sentence: expected and existing features, and lines to paste.
        field: of the selector that is at fault.
    """

    def __init__(self, sentence: str, field: str) -> None:
        super().__init__(sentence)
        self.field = field


def selected(part: StepPart, selector: Selector) -> tuple[FoundFeature, ...]:
    """The features that a selector means, by their places.

    Raises:
        SelectionError: it selects none, or another number than it states.
    """
    if selector.faces:
        found: Sequence[FoundFeature] = (_of_faces(part, selector),)
    else:
        found = _nearest(part, selector, _fitting(part, selector))
    if selector.along is not None:
        found = [part.shell.made_of(own.faces, selector.along) for own in found]
    return tuple(by_place(found))


def _of_faces(part: StepPart, selector: Selector) -> FoundFeature:
    """The feature that exactly these faces are."""
    for number in selector.faces:
        if number not in part.shell.faces:
            raise SelectionError(f"expected faces of {shown(part.name)!r}, got #{number} of something else", "faces")
    if not part.shell.is_one(selector.faces):
        raise SelectionError("expected faces that lie on one surface, got faces of several", "faces")
    made = part.shell.made_of(selector.faces)
    if selector.kind not in (None, made.kind):
        raise SelectionError(f"expected a {selector.kind}, got faces of a {made.kind}", "kind")
    return made


def _fitting(part: StepPart, selector: Selector) -> list[FoundFeature]:
    """The features that match a selector, wherever they lie."""
    found = [feature for feature in part.features if not feature.loose]
    if selector.face is not None:
        found = [feature for feature in part.features if selector.face in (*feature.faces, *feature.repeated)]
        if not found:
            raise SelectionError(
                f"expected a face of {shown(part.name)!r}, got #{selector.face} of something else", "face"
            )
    if selector.name is not None:
        found = [feature for feature in part.features if selector.name in feature.names]
        if not found:
            known = sorted({name for feature in part.features for name in feature.names})
            got = f"got {shown(selector.name)!r}, which is none"
            raise SelectionError(f"expected the name of a face, {got}{hint(selector.name, known)}", "face")
    if (field := _by_drawing(selector)) is not None:
        meant = _named(part, selector, field)
        found = [own for own in meant if selector.face is None or selector.face in (*own.faces, *own.repeated)]
    for field, kept in (("kind", _of_kind(found, selector)), ("diameter", _of_size(found, selector))):
        both = [own for own in found if own in kept]
        if not both:
            said = f"a {selector.kind}" if field == "kind" else f"a diameter of {selector.diameter:.9g} mm"
            there = _lines(part, found)
            raise SelectionError(f"expected {said}, found none there; there are {there}", field)
        found = both
    return found


def _by_drawing(selector: Selector) -> str | None:
    """The field by which a drawing names the features; None if it does not."""
    return next((own for own in ("datum", "pmi", "tolerance") if getattr(selector, own) is not None), None)


def _named(part: StepPart, selector: Selector, field: str) -> list[FoundFeature]:
    """The features whose faces a drawing names."""
    fitting = [own for own in part.named if _fits(own, selector)]
    if not fitting:
        what = {"datum": ("datum",), "pmi": ("tolerance", "dimension"), "tolerance": ("tolerance",)}[field]
        known = sorted({own.kind if field == "tolerance" else own.name for own in part.named if own.what in what})
        got = shown(getattr(selector, field))
        beside = f" {_said(selector)}" if field == "tolerance" else ""
        raise SelectionError(
            f"expected {_words(field)} of {shown(part.name)!r}, got {got!r}{beside}, which it does not have"
            f"{hint(got, known)}; it has {', '.join(map(shown, known[:MOST_KNOWN])) or 'none'}",
            field,
        )
    faces = list(dict.fromkeys(face for own in fitting for face in own.faces))
    found = []
    for feature in part.features:
        here = [face for face in faces if face in feature.faces]
        if feature.kind == "plane" and here and len(here) < len(feature.faces):
            exact = part.shell.made_of(here)
            found.append(replace(exact, names=feature.names, colour=feature.colour, on=part.point_on(here)))
        elif here or set(faces) & {*feature.repeated}:
            found.append(feature)
    if not found:
        words = "; ".join(shown(own.words) for own in fitting[:MOST_SHOWN])
        raise SelectionError(f"expected an item with faces, got {words} without faces on this part", field)
    return found


def _fits(named: Named, selector: Selector) -> bool:
    """True if a name of a drawing matches a selector."""
    if selector.datum is not None and (named.what != "datum" or named.name != selector.datum):
        return False
    if selector.pmi is not None and (named.what == "datum" or named.name != selector.pmi):
        return False
    if selector.tolerance is not None and (named.what != "tolerance" or named.kind != selector.tolerance):
        return False
    if selector.value is not None and (named.value is None or abs(named.value - selector.value) > SAME_VALUE):
        return False
    return selector.datums is None or _letters(named.datums) == _letters(selector.datums)


def _letters(datums: str) -> list[str]:
    return [own.strip() for own in datums.split("|")]


def _said(selector: Selector) -> str:
    value = [] if selector.value is None else [f"{selector.value:.9g} mm"]
    return " ".join([*value, *([] if selector.datums is None else [f"to {selector.datums}"])])


def _words(field: str) -> str:
    return {
        "datum": "the letter of a datum",
        "pmi": "the name of a tolerance or dimension",
        "tolerance": "the kind of a tolerance",
    }[field]


def _of_kind(found: Sequence[FoundFeature], selector: Selector) -> Sequence[FoundFeature]:
    return found if selector.kind is None else [own for own in found if own.kind == selector.kind]


def _of_size(found: Sequence[FoundFeature], selector: Selector) -> Sequence[FoundFeature]:
    if selector.diameter is None:
        return found
    return [own for own in found if own.radius and abs(2 * own.radius - selector.diameter) <= SAME_SIZE]


def _nearest(part: StepPart, selector: Selector, fitting: list[FoundFeature]) -> Sequence[FoundFeature]:
    """Matching features, as many as a selector states, the nearest to its point if it states one."""
    count = selector.count or 1
    if selector.near is None:
        if len(fitting) != count:
            words = "exactly 1 feature" if selector.count is None else f"exactly {count} features"
            field = "" if selector.count is None else "count"
            raise SelectionError(f"expected {words}, found {len(fitting)}: {_lines(part, fitting)}", field)
        return fitting
    point, mesh = np.array(selector.near), part.mesh()
    distances = sorted(((distance(mesh, own, point), k) for k, own in enumerate(fitting)))
    if len(distances) < count:
        raise SelectionError(f"expected {count} features, found {len(fitting)}: {_lines(part, fitting)}", "count")
    ordered = [fitting[k] for _, k in distances]
    farthest = distances[count - 1][0]
    if selector.within is not None and farthest > selector.within:
        got = f"the nearest is {farthest:.6g} mm away" if count == 1 else f"one is {farthest:.6g} mm away"
        raise SelectionError(f"expected it within {selector.within:g} mm, but {got}: {_lines(part, ordered)}", "within")
    if len(distances) > count:
        following = distances[count][0]
        if following < TWICE * farthest or following < farthest + SAME_DISTANCE:
            words = "expected a point to which the next feature is at least twice as far"
            got = f"got {farthest:.6g} mm and {following:.6g} mm"
            raise SelectionError(f"{words}, {got}: {_lines(part, ordered)}", "near")
    return ordered[:count]


def distance(mesh: FaceMesh, feature: FoundFeature, point: Array) -> float:
    """Distance of a point (3,) from a feature [mm]: from its faces, of a hole, pin or ball from its axis as well."""
    if feature.kind == "unread":
        return math.inf
    found = mesh.distance(point, feature.faces, less_error=feature.kind != "free form")
    if math.isinf(found):  # it has no triangles
        found = float(np.linalg.norm(point - np.array(feature.on)))
    if feature.kind in ("hole", "pin", "ball", "socket"):
        found = min(found, feature.axis_distance(point))
    return found


def line_of(feature: FoundFeature) -> str:
    """A selector that means a feature, as a scene has it.

    It gives the place of the feature: that stays when the file is exported again, numbers of faces do not.
    """
    round_one = feature.kind in ("hole", "pin", "ball", "socket")
    place = feature.at if round_one else feature.on
    near = ", ".join(f"{round(own, 4) + 0.0:.10g} mm" for own in place)
    size = f", diameter: {round(2 * feature.radius, 6):.10g} mm" if round_one else ""
    return f"{{kind: {feature.kind}{size}, near: [{near}]}}"


def best_line(part: StepPart, feature: FoundFeature) -> str:
    """A selector that means a feature: by the letter of a datum that is this feature alone, else by its place."""
    if feature.loose:
        return f'{{face: "#{feature.faces[0]}"}}'
    for own in part.named:
        alone = own.what == "datum" and own.name and {*own.faces} <= {*feature.faces, *feature.repeated}
        if alone and (feature.kind != "plane" or {*feature.faces} <= {*own.faces}):
            return f"{{datum: {own.name}}}" if own.name.isalpha() else line_of(feature)
    return line_of(feature)


def _lines(part: StepPart, found: Sequence[FoundFeature]) -> str:
    """The first few features, each as a line to paste."""
    listed = "; ".join(f"{line_of(own)} ({numbers(own)})" for own in found[:MOST_SHOWN])
    more = f"; and {len(found) - MOST_SHOWN} more" if len(found) > MOST_SHOWN else ""
    return f"{listed}{more}" if found else f"none of {shown(part.name)!r}"


def numbers(feature: FoundFeature) -> str:
    """The faces of a feature: "#12, #34"."""
    return ", ".join(f"#{face}" for face in feature.faces)


def names(found: Sequence[FoundFeature]) -> Iterator[str]:
    """A name for each feature, by its kind and its number among those of its kind: "hole_1"."""
    counts: dict[str, int] = {}
    for own in found:
        word = own.kind.replace(" ", "_")
        counts[word] = counts.get(word, 0) + 1
        yield f"{word}_{counts[word]}"
