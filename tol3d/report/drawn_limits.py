"""Limits written in a scene as on a drawing, and their meaning."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any

from tol3d.distributions.base import DistributionSpec
from tol3d.report.declared import declared_table
from tol3d.report.page import PageItem, note, titled
from tol3d.report.system_check import law_name
from tol3d.runs.summary.shows import Shows
from tol3d.scene.schema import Scene
from tol3d.scene.tolerance import laws_in
from tol3d.standards import iso_2768

NOMINAL_NOTE = (
    "a number in front of limits, such as 40.1 mm +0.12/0, is not compared with the part: its size is the part's"
)


@dataclass(frozen=True)
class DrawnRow:
    """A limit as drawn, and its numbers."""

    drawn: Annotated[str, Shows("as drawn", "words")]
    lower: Annotated[str, Shows("lower")]
    upper: Annotated[str, Shows("upper")]
    law: Annotated[str, Shows("law", "words")]


def drawn_limits(scene: Scene) -> list[PageItem]:
    """Every limit that stands as on a drawing, with its numbers; nothing where there are none."""
    rows = [(name, _row(law, law_name(law.resolve(scene.files)))) for name, law in _drawn(scene)]
    if not rows:
        return []
    return [*titled("limits as drawn", declared_table("", rows)), note(NOMINAL_NOTE), *_general(scene)]


def _general(scene: Scene) -> Iterator[PageItem]:
    """Which dimensions took the general tolerance, and what it says that is not drawn."""
    if scene.general is None:
        return
    sizes, forms = iso_2768.classes(scene.general)
    taken = ", ".join(scene.origin.general) or "none"
    yield note(f"general tolerance ISO 2768-{sizes}, taken by dimensions without one of their own: {taken}")
    if forms:
        yield note(
            f"class {forms} of ISO 2768-2 (form, orientation, run-out) is not applied: state zones where they matter"
        )


def _drawn(scene: Scene) -> Iterator[tuple[str, DistributionSpec]]:
    for (_, name), entry in scene.entries().items():
        for law in laws_in(entry):
            if law.drawn is not None:
                yield str(name), law


def _row(law: DistributionSpec, name: str) -> DrawnRow:
    """Its limits as drawn, and as numbers, with the signs of their units."""
    given = law.quantities()
    drawn, lower, upper = (
        str(text).replace(" um", " µm") for text in (_told(law.drawn), given["lower"], given["upper"])
    )
    return DrawnRow(drawn, lower, upper, name)


def _told(written: Any) -> str:
    """As a drawing has it: H7 of 32 mm, ISO 2768-m of 60 mm, ±0.1 mm."""
    if isinstance(written, dict):
        if "limits" in written:
            return _told(written["limits"])
        if "iso_1328_2" in written:
            return f"ISO 1328-2 {written['iso_1328_2']} of m {written['module']}, d {written['of']}"
        word = written["fit"] if "fit" in written else f"ISO 2768-{written['general']}"
        return f"{word} of {written['of']}" if "of" in written else f"{word}, leg of {written['leg']}"
    return " to ".join(str(own) for own in written) if isinstance(written, list) else str(written)
