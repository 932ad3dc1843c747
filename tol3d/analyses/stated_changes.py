"""Other tolerances as a user states them: limits, a scale or a width by contributor, or a factor."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from tol3d.analyses.response import Response
from tol3d.analyses.stated_classes import NO_SIZES, Sizes, class_limits, class_of
from tol3d.analyses.stated_sizes import NO_NOMINALS, deviations_of
from tol3d.errors import InputError
from tol3d.scene.nearest import hint
from tol3d.statistics.distributions import Distribution
from tol3d.statistics.distributions.base import Stays
from tol3d.statistics.distributions.drawn import limits_written
from tol3d.statistics.distributions.size_limits import sizes_written
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.draw import Draw, component_sigmas
from tol3d.study.system.other_laws import Zoned
from tol3d.units import UNITS, Quantity, expectation

RANGE: Final = re.compile(r"(?P<low>.*[^.\s])\s*\.\.\s*(?P<high>[^.].*|\.\d.*)")
EXAMPLES: Final = "±10 um, +0.02/0 mm, -5 um..+10 um, H7 of a size, cd25 of teeth, or 5 um of a zone or a scale"


@dataclass(frozen=True)
class Change:
    """Change of a tolerance.

    Args:
        name: of the line that states it, see study/trials/simulation.py; all its contributors change.
        limits: new limits of their draw [mm, rad or K].
        size: new size of its zone, or of a law stated by one number.
        factor: on its width.
        stays: which limit does, where it is scaled; default: see study/system/other_laws.py, `naturally_stays`.
        of_class: the class that its limits are of, such as H7, cd25 or {fit: H7, of: 60 mm}; "" for none.
    """

    name: str
    limits: tuple[float, float] | None = None
    size: float | None = None
    factor: float | None = None
    stays: Stays | None = None
    of_class: str = ""


def change_of(
    response: Response,
    text: str,
    sizes: Mapping[str, Sizes] = NO_SIZES,
    nominals: Mapping[str, float] = NO_NOMINALS,
) -> Change:
    """Change by `--set NAME=VALUE`: `±10um`, `+0.02/0 mm`, `-5 um..+10 um`, `5 um`, a class such as `H7`, or sizes.

    Args:
        response: with the tolerances of the scene.
        text: as described.
        sizes: nominal ones by line, at which classes are read.
        nominals: of measured sizes by line [mm], of which `23.349 / 23.386 mm` are limits.

    Raises:
        InputError: no such contributor, or no such value of it.
    """
    name, value = _split(response, "--set", text)
    contributor = next(own for own in response.contributors if own.name == response.lines[name][0])
    try:
        if own_class := class_of(value):
            return Change(name, limits=class_limits(own_class, sizes.get(name, {})), of_class=own_class)
        if sizes_written(value) is not None and (name in nominals or not RANGE.fullmatch(value)):
            law = response.drawn_by(contributor.name).distribution
            return Change(name, limits=deviations_of(law, value, nominals.get(name)))
        pair = limits_written(value)
    except InputError as error:
        raise InputError(f"--set {text!r}: {error}") from None
    if pair is not None:
        low, high = (_internal(contributor, text, own) for own in pair)
        return Change(name, limits=(low, high))
    if found := RANGE.fullmatch(value):
        return Change(
            name, limits=(_length(contributor, text, found["low"]), _length(contributor, text, found["high"]))
        )
    return Change(name, size=_length(contributor, text, value))


def factor_of(response: Response, text: str, option: str = "--factor") -> Change:
    """Change by `--factor NAME=0.5`.

    Raises:
        InputError: no such contributor, or no factor above 0.
    """
    name, value = _split(response, option, text)
    try:
        factor = float(value)
    except ValueError:
        factor = 0.0
    if not 0.0 < factor < float("inf"):
        raise InputError(f"{option} {text!r}: expected a factor above 0 such as 0.5, got {value!r}")
    return Change(name, factor=factor)


def changed(response: Response, changes: Sequence[Change], *, physical: bool = True) -> Response:
    """The same system with other tolerances.

    Args:
        response: with the tolerances of the scene.
        changes: one per line of the scene.
        physical: see Response.scaled.

    Raises:
        InputError: one that cannot be, by the name of its line; two of one line.
    """
    names = [own.name for own in changes]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"{name}: expected one change of it, got {names.count(name)}")
    factors: dict[str, float] = {}
    stays: dict[str, Stays] = {}
    laws: dict[str, Distribution] = {}
    widths: dict[str, float] = {}
    for change in changes:
        for name in response.lines[known(response, change.name, change.name)]:
            draw = response.drawn_by(name)
            if change.factor is not None:
                factors[name] = change.factor
                stays |= {} if change.stays is None else {name: change.stays}
            elif change.size is not None and isinstance(draw, Zoned):
                widths[name] = change.size
            else:
                laws[name] = law_of(draw, change)
    return response.scaled(factors, stays, physical=physical).sized(widths).with_laws(laws)


MANY_TIMES: Final = 100.0
"""Factor on a sigma from which a change is most likely a slip in the unit."""


def slips(before: Response, after: Response) -> Iterator[str]:
    """Warnings of tolerances that become so much wider that a unit is most likely wrong."""
    for contributor in before.contributors:
        sigmas = [max(component_sigmas(one.draws[contributor.name])) for one in (before, after)]
        if sigmas[1] > MANY_TIMES * sigmas[0] > 0.0:
            times = f"{sigmas[1] / sigmas[0]:.3g} times as wide as in the scene"
            yield f"{contributor.name}: {told(contributor, after.draws[contributor.name])} is {times}; check the unit"


def law_of(draw: Draw, change: Change) -> Distribution:
    """The law of a draw within other limits, or of another size.

    Raises:
        InputError: it has no such law; by the name of the change.
    """
    law = draw.distribution
    if isinstance(draw, Zoned):
        raise InputError(f"{change.name}: expected the width of its zone, such as 10 um, got limits")
    if not isinstance(law, Distribution):
        raise InputError(f"{change.name}: expected a contributor that is drawn by a law; say --factor")
    try:
        return law.within(*change.limits) if change.limits is not None else law.of_size(change.size or 0.0)
    except InputError as error:
        raise InputError(f"{change.name}: {error}") from None


def _split(response: Response, option: str, text: str) -> tuple[str, str]:
    name, sign, value = (own.strip() for own in text.rpartition("="))
    if not (sign and name and value):
        raise InputError(f"{option}: expected NAME=VALUE, such as {EXAMPLES}, got {text!r}")
    return known(response, option, name), value


def known(response: Response, option: str, name: str) -> str:
    """The name of a line that states a tolerance; of one in an included file its name there is enough.

    Raises:
        InputError: there is none of that name, or it is one of several contributors of a line.
    """
    if name in response.lines:
        return name
    for line, contributors in response.lines.items():
        if name in contributors:
            raise InputError(f"{option}: {shared(name, line, contributors)}")
    in_files = [own.name for own in response.simulation.lines if own.in_file == name]
    if len(in_files) == 1:
        return in_files[0]
    raise InputError(f"{option}: expected a contributor, got {name!r}{hint(name, response.lines)}")


def shared(name: str, line: str, contributors: Sequence[str]) -> str:
    """Sentence that refuses a change of one of the contributors that a line makes."""
    every = ", ".join(map(repr, contributors))
    return f"expected {line!r}, one line of the scene that states all of {every}, got {name!r} alone"


def _length(contributor: Contributor, text: str, value: str) -> float:
    dimension = UNITS.get(contributor.unit)
    try:
        quantity = Quantity.parse(value.strip())
    except ValueError as error:
        wanted = EXAMPLES if dimension is None else f"{expectation(dimension)}: {EXAMPLES}"
        raise InputError(f"--set {text!r}: expected {wanted}; {error}") from None
    return _internal(contributor, text, quantity)


def _internal(contributor: Contributor, text: str, quantity: Quantity) -> float:
    dimension = UNITS.get(contributor.unit)
    if quantity.dimension != dimension:
        wanted = f"in {contributor.unit}" if dimension is None else expectation(dimension)
        raise InputError(f"--set {text!r}: expected {wanted}, got {quantity}")
    return quantity.internal


def told(contributor: Contributor, draw: Draw) -> str:
    """The tolerance of a draw in words and numbers, such as `normal -20 … 20 um`."""
    law, per, unit = draw.distribution, contributor.per_unit, contributor.unit
    sign = {"um": "µm", "1": ""}.get(unit, unit)
    if isinstance(draw, Zoned):
        return f"zone of {draw.width / per:.5g} {sign}".strip()
    name = law.words if isinstance(law, Distribution) else ""
    limits = law.limits if isinstance(law, Distribution) else None
    if limits is not None:
        return f"{name} {limits[0] / per:.5g} … {limits[1] / per:.5g} {sign}".strip()
    scale = getattr(law, "scale", None)
    if scale is not None:
        return f"{name} {scale / per:.5g} {sign}".strip()
    return f"{name} mean {law.mean / per:.5g}, sigma {law.sigma / per:.5g} {sign}".strip()
