"""Tolerances and datums of a scene as the 3D view flags them: a line of text at the parts and features they hold."""

from collections.abc import Iterator
from typing import Any, Final

from tol3d.apps.workbench.card import written
from tol3d.apps.workbench.session import Session
from tol3d.cad.step.frame import MODIFIER_SIGNS, SYMBOLS, ZONE_SIGNS
from tol3d.scene import Scene
from tol3d.statistics.distributions import Distribution

DRAWN: Final = {
    "profile": "surface profile",
    "circular_run_out": "circular runout",
    "axial_run_out": "circular runout",
    "total_run_out": "total runout",
}
"""Kinds of tolerance by the words of ISO 1101, where they have others in a scene."""
MODIFIERS: Final = {
    "mmc": MODIFIER_SIGNS["maximum material requirement"],
    "lmc": MODIFIER_SIGNS["least material requirement"],
}
DATUM: Final = "datum"


def flags(session: Session) -> list[dict[str, Any]]:
    """A flag a datum and a tolerance, for JSON.

    Of each the `name` of the tolerance, "" of a datum; `of`, names of parts and features; `words`.
    """
    scene, stated = session.scene, dict(_stated(session))
    found, datums = list[dict[str, Any]](), dict[str, None]()
    for name, spec in scene.tolerances.items():
        words = _frame(spec) or f"{_kind(spec)} {stated.get(name, '')}".strip()
        found.append({"name": name, "of": [*_subjects(scene, spec)], "words": words})
        for datum in getattr(spec, "named_datums", ()):
            part = str(getattr(spec, "of", "")).partition(".")[0]
            datums |= dict.fromkeys(f"{part}.{feature}" for feature in datum.features)
    return [*({"name": "", "of": [name], "words": DATUM} for name in datums), *found]


def _stated(session: Session) -> Iterator[tuple[str, str]]:
    """Width or limits of each tolerance that has a law, by its name."""
    known = {own.name: own for own in session.response.contributors}
    for line in session.simulation.lines:
        if contributor := known.get(line.contributors[0]):
            law, words = contributor.draw.distribution, written(contributor, contributor.draw)
            without = isinstance(law, Distribution) and law.limits is None
            for entry in line.entries:
                yield entry, ("σ " if without else "") + words.replace("um", "µm")


def _subjects(scene: Scene, spec: Any) -> Iterator[str]:
    """Features that a tolerance holds; else the parts, those of a move that it is of."""
    if features := getattr(spec, "all_of", ()):
        yield from features
        return
    for reference in spec.references():
        if reference.name in scene.parts:
            yield reference.name
        elif reference.name in scene.moves:
            parts = (own.name for own in scene.moves[reference.name].references())
            yield from dict.fromkeys(own for own in parts if own in scene.parts)


def _kind(spec: Any) -> str:
    """Kind in words; of a dimension its direction, if that is an axis of its part."""
    if spec.kind != "plus_minus":
        return str(spec.kind).replace("_", " ")
    along = [] if spec.along is None else [abs(own) for own in spec.along]
    return "xyz"[along.index(1.0)] if sorted(along) == [0.0, 0.0, 1.0] else ""


def _frame(spec: Any) -> str:
    """The feature control frame of a tolerance with a zone; "" of others."""
    zone = getattr(spec, "zone", None)
    sign = SYMBOLS.get(DRAWN.get(spec.kind, spec.kind))
    if zone is None or sign is None:
        return ""
    size = f"{ZONE_SIGNS['diameter'] if zone.diameter else ''}{zone.stated}".replace("um", "µm")
    width = " ".join((size, *_signs(getattr(spec, "modifier", None))))
    datums = (" ".join(("-".join(own.features), *_signs(_boundary(own)))) for own in spec.named_datums)
    return " | ".join((sign, width, *datums))


def _boundary(datum: Any) -> str | None:
    return None if datum.gauge is None else str(datum.boundary)


def _signs(modifier: str | None) -> list[str]:
    return [MODIFIERS[modifier]] if modifier else []
