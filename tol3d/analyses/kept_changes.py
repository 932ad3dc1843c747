"""Other tolerances kept in a scene: its text says what the changes of a response are."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

import numpy as np

from tol3d.analyses.response import Response
from tol3d.analyses.stated_changes import Change, changed, known, law_of
from tol3d.analyses.stated_classes import Sizes, class_size, sizes_of, with_own_size
from tol3d.analyses.stated_limits import OtherLimits, limited
from tol3d.errors import InputError
from tol3d.files import Files
from tol3d.scene import Scene
from tol3d.scene.bases import ToleranceEntry, ToleranceSpec
from tol3d.scene.edit import with_limits, with_tolerances
from tol3d.scene.splice import flow_text
from tol3d.statistics.distributions import Distribution
from tol3d.statistics.distributions.derived import Derived
from tol3d.study.system.draw import Draw
from tol3d.study.system.other_laws import Zoned, naturally_stays, scaled
from tol3d.study.trials.simulation import Line
from tol3d.units import Quantity

CLASSES: Final = ("fit", "general", "iso_1328_2", "din_3967", "din_3964", "iso_class", "grade")
"""Keys by which a scene states limits of a standard."""
SAME: Final = 1e-9
"""Share of a tolerance by which limits may differ that are the same: ten digits are written."""


def scene_with(
    response: Response,
    scene: Scene,
    changes: Sequence[Change],
    limits: Sequence[OtherLimits] = (),
    *,
    physical: bool = True,
) -> Scene:
    """The scene, in its text too, whose simulation draws what `changed(response, changes)` draws, to ten digits.

    Values are changed where they stand, in their units and words; limits of a standard, such as `{fit: H7, …}`, become
    numbers, see `in_numbers`, or those of another class where that is asked for. A tolerance of an included file is
    written into the scene, for each of its includes.

    Args:
        response: of the scene, with its own tolerances.
        scene: the scene.
        changes: one per line of the scene.
        limits: other limits of measures; of an end of a curve those of the curve.
        physical: see Response.scaled.

    Raises:
        InputError: a change that cannot be, or that the scene cannot state in numbers, by the name of its line.
    """
    changed(response, changes, physical=physical)
    lines = {line.name: line for line in response.simulation.lines}
    by_line = {known(response, change.name, change.name): change for change in changes}
    sizes, specs = sizes_of(scene, lines.values()), dict[str, ToleranceEntry]()
    for name, change in by_line.items():
        line = lines.get(name, Line(name, ()))
        if not line.entries:
            raise InputError(f"{name}: expected a tolerance of the scene, got what a move says")
        _refuse_half(line, by_line, lines)
        draw = response.drawn_by(line.contributors[0])
        for entry in line.entries:
            try:
                specs[entry] = _stated(scene.tolerances[entry], change, draw, sizes.get(name, {}), scene.files)
            except InputError as error:
                raise InputError(f"{entry}: {error}") from None
    kept = with_tolerances(scene, specs) if specs else scene
    others = dict[str, dict[str, Quantity | None]]()
    measures = limited(response.of(*(own.measure for own in limits)).measures, limits)
    for own, measure in zip(limits, measures, strict=True):
        others.setdefault(response.source(measure).name, {}).update(own.stated)
    return with_limits(kept, others) if others else kept


def _stated(spec: ToleranceEntry, change: Change, draw: Draw, sizes: Sizes, files: Files) -> ToleranceEntry:
    size = class_size(change.of_class, sizes)
    if change.of_class and size is not None and isinstance(spec, ToleranceSpec) and spec.distribution.between:
        return spec.of_class(with_own_size(change.of_class, sizes)[0], size)
    spec = spec.in_numbers(draw)
    if change.factor is not None:
        return spec.scaled(change.factor, change.stays or naturally_stays(draw), files)
    if change.size is not None and isinstance(draw, Zoned):
        return spec.scaled(change.size / draw.width, "middle", files)
    law = law_of(draw, change)
    if not isinstance(spec, ToleranceSpec) and (factor := _wider(draw, law)) is not None:
        return spec.scaled(factor, naturally_stays(draw), files)
    return spec.with_law(law.measured if isinstance(law, Derived) else law)


def _wider(draw: Draw, law: Distribution) -> float | None:
    """The factor by which a law is that of a draw; None where it is another one."""
    before, after = draw.distribution, law.limits
    if after is None or not before.low < before.high:
        return None
    factor = (after[1] - after[0]) / (before.high - before.low)
    wider = scaled(draw, factor).distribution
    same = np.allclose((wider.low, wider.high), after, rtol=0.0, atol=SAME * (after[1] - after[0]))
    return factor if same else None


def _refuse_half(line: Line, changes: Mapping[str, Change], lines: Mapping[str, Line]) -> None:
    """Refuse a change of one of the lines of a tolerance alone, such as of a pattern without that of its motion."""
    together = [own.name for own in lines.values() if own.entries == line.entries]
    factors = {changes[name].factor if name in changes else None for name in together}
    if len(together) > 1 and (len(factors) > 1 or None in factors):
        several = " and ".join(map(repr, together))
        raise InputError(f"{line.name}: expected one factor on {several}, which one tolerance of the scene states")


def in_numbers(before: Scene, after: Scene) -> dict[str, str]:
    """Words on limits of a standard that became numbers, by tolerance, such as "±0.0085 mm, was js7"."""
    found = {
        name: " and ".join(_numbered(*(own.model_dump(mode="json", exclude_unset=True) for own in (spec, other))))
        for name, spec in before.tolerances.items()
        if (other := after.tolerances.get(name, spec)) is not spec
    }
    return {name: words for name, words in found.items() if words}


def _numbered(before: Any, after: Any) -> Iterator[str]:
    if not isinstance(before, dict) or before == after:
        return
    for key in CLASSES:
        if key in before and not (isinstance(after, dict) and after.keys() & {*CLASSES}):
            was = before[key] if isinstance(before[key], str) else f"{key} {before[key]}"
            yield f"{after if isinstance(after, str) else flow_text(after)}, was {was}"
            return
    for key in before.keys() & after.keys() if isinstance(after, dict) else ():
        yield from _numbered(before[key], after[key])
