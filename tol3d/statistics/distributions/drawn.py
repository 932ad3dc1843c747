"""A law by its limits as a drawing writes them: `±0.1 mm`, `40.1 mm +0.12/0`, `23.3 / 23.4 mm`, `{fit: H7, of: 32 mm}`.

What is written becomes one of the kinds of law, by the law that is named beside it or by the default law of the scene;
it is kept as `drawn` of that law, so that the scene is dumped as it was written.
"""

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import partial
from typing import Annotated, Any, Final, Self

from pydantic import AfterValidator, BeforeValidator, Field, TypeAdapter, ValidationError, model_validator
from pydantic_core import PydanticCustomError

from tol3d.errors import InputError
from tol3d.statistics.distributions.base import Distribution, DistributionSpec
from tol3d.statistics.distributions.default_law import LimitLaw, StatedLimitLaw, UniformBetween
from tol3d.statistics.distributions.size_limits import LONGEST, NUMBER, UNIT, resized, size_limits, sizes_written
from tol3d.statistics.distributions.unsized import SIZE, STANDARDS, UnsizedSpec
from tol3d.statistics.standards import din_3967, iso_286, iso_1328_2, iso_2768
from tol3d.strict import Strict, refused
from tol3d.units import Of, Positive, Quantity, shown

DEFAULT_LAW: Final = "default_law"
"""The key of a scene that names it."""
KEYS: Final = ("fit", "general", "iso_1328_2", "iso_17485", "din_3967", "din_3964", "limits")
"""Keys, one of which states the form of limits, where no kind of law is stated."""
PLUS_MINUS: Final = ("±", "+-", "+/-")
MINUS: Final = str.maketrans({"−": "-"})  # as drawings are copied
NOMINAL: Final = rf"(?:(?P<nominal>{NUMBER})\s*(?P<nominal_unit>{UNIT})?\s*)?"
SYMMETRIC: Final = re.compile(rf"\s*{NOMINAL}(?P<sign>±|\+-|\+/-)\s*(?P<size>{NUMBER})\s*(?P<unit>{UNIT})?\s*")
TWO: Final = re.compile(
    rf"\s*{NOMINAL}(?P<one>[+-]{NUMBER}|0)\s*(?P<one_unit>{UNIT})?\s*/\s*(?P<other>[+-]{NUMBER}|0)\s*(?P<unit>{UNIT})?\s*"
)
WRITTEN: Final = 'limits such as "±0.1 mm", "40.1 mm +0.12/0" or [-19 um, -30 um]'

_default: ContextVar[LimitLaw | None] = ContextVar("default_law", default=None)


def _of_standard(read: Callable[[str], object], text: str) -> str:
    try:
        read(text)
    except InputError as error:
        expected, _, got = str(error).removeprefix("expected ").partition(", got ")
        raise refused("", expected, got) from None
    return text


def _digits(value: object) -> object:
    """A number as its text: it is no class alone, and the standard's sentence says which are."""
    return str(value) if type(value) is int else value


_series, _field = partial(_of_standard, din_3967.series), partial(_of_standard, din_3967.field)


class FitSpec(Strict):
    """`{fit: H7, of: 32 mm}`: limits of ISO 286."""

    fit: str = Field(description="tolerance class of ISO 286, such as H7 of a hole or g6 of a shaft")
    of: Annotated[Quantity, Of("length"), Positive()] = Field(description="nominal size")
    law: StatedLimitLaw | None = Field(default=None, description="default: by the scene's default_law")


class GeneralSpec(Strict):
    """`{general: m, of: 60 mm}` or `{general: m, leg: 60 mm}`: limits of ISO 2768-1 of a size or an angle."""

    general: str = Field(description="class f, m, c or v of ISO 2768-1")
    of: Annotated[Quantity, Of("length"), Positive()] | None = Field(default=None, description="nominal size")
    leg: Annotated[Quantity, Of("length"), Positive()] | None = Field(
        default=None, description="of an angle, the length of its shorter leg"
    )
    law: StatedLimitLaw | None = Field(default=None, description="default: the scene's default_law")

    @model_validator(mode="after")
    def _refuse_other_than_one(self) -> Self:
        if (self.of is None) == (self.leg is None):
            raise refused("", "either `of`, the nominal size, or `leg` of an angle", "both" if self.of else "neither")
        return self

    @property
    def limit(self) -> Quantity:
        """Plus and minus."""
        if self.leg is not None:
            return Quantity(iso_2768.angular(self.general, self.leg.internal), "deg")
        return Quantity(iso_2768.linear(self.general, self.of.internal if self.of else 0.0), "mm")


class GradeSpec(Strict):
    """`{iso_1328_2: F_r 7, module: 2 mm, of: 48 mm}`: from nothing to what a grade of ISO 1328-2:1997 allows."""

    iso_1328_2: str = Field(description="F_r, F_i'' or f_i'' and the grade, such as F_r 7")
    module: Annotated[Quantity, Of("length"), Positive()] = Field(description="of what has the grade")
    of: Annotated[Quantity, Of("length"), Positive()] = Field(description="reference diameter")
    law: StatedLimitLaw | None = Field(default=None, description="default: the scene's default_law")


class SeriesSpec(Strict):
    """`{din_3967: cd25}`: allowances of the tooth thickness of a cylindrical gear, by its reference diameter."""

    din_3967: Annotated[str, BeforeValidator(_digits), AfterValidator(_series)] = Field(
        description="letters and number, such as cd25"
    )
    law: StatedLimitLaw | None = Field(default=None, description="default: the scene's default_law")


class FieldSpec(Strict):
    """`{din_3964: js7}`: allowances of the centre distance of cylindrical gears, by its nominal value."""

    din_3964: Annotated[str, BeforeValidator(_digits), AfterValidator(_field)] = Field(
        description="js5 to js11; a number alone is a class of axes too"
    )
    law: StatedLimitLaw | None = Field(default=None, description="default: the scene's default_law")


class LimitsSpec(Strict):
    """`{limits: ±0.1 mm, law: {kind: uniform}}`: limits with a law of their own."""

    limits: str | list[str] = Field(description=WRITTEN.replace('"', ""))
    law: StatedLimitLaw | None = Field(default=None, description="default: by the scene's default_law")


Limited = FitSpec | GeneralSpec | GradeSpec | LimitsSpec
Sized = SeriesSpec | FieldSpec
"""Classes whose limits depend on a size of the scene."""
DRAWN: Final[TypeAdapter[Any]] = TypeAdapter(Limited | Sized | Annotated[str, Field(examples=["±0.1 mm"])] | list[str])
"""For the JSON Schema of what may be written."""
_SPECS: Final[dict[str, type[Limited | Sized]]] = {
    "fit": FitSpec,
    "general": GeneralSpec,
    "iso_1328_2": GradeSpec,
    "din_3967": SeriesSpec,
    "din_3964": FieldSpec,
    "limits": LimitsSpec,
}
_LAW: Final[TypeAdapter[Any]] = TypeAdapter(StatedLimitLaw)


@contextmanager
def default_law(given: Any) -> Iterator[None]:
    """Use this law for limits without one of their own: a scene's statement of it, or a LimitLaw."""
    token = _default.set(_read(given))
    try:
        yield
    finally:
        _default.reset(token)


def _read(given: Any) -> LimitLaw | None:
    if given is None or isinstance(given, LimitLaw):
        return given
    try:
        law: LimitLaw = _LAW.validate_python(given)
    except ValidationError:  # which the scene's own field reports
        return UniformBetween(kind="uniform")
    return law


def is_drawn(value: Any) -> bool:
    """True if a value is limits as a drawing writes them, right or wrong."""
    if isinstance(value, str):
        signs = any(sign in value for sign in PLUS_MINUS) or "/" in value
        return signs or is_series(value) or sizes_written(value) is not None
    if isinstance(value, dict):
        return "kind" not in value and any(key in value for key in KEYS)
    return isinstance(value, list | tuple)


def _is(read: Callable[[str], object], text: str) -> bool:
    try:
        read(text)
    except InputError:
        return False
    return True


is_series, is_field = partial(_is, din_3967.series), partial(_is, din_3967.field)


def drawn_law(value: Any) -> DistributionSpec:
    """The law that limits on a drawing stand for.

    Raises:
        PydanticCustomError, ValidationError: they make no sense, or no law is named; for pydantic to pass on.
    """
    law = _default.get()
    if isinstance(value, dict):
        stated = _stated(value)
        law = stated.law or law
        if isinstance(stated, Sized):
            standard = next(key for key in STANDARDS if key in value)
            return UnsizedSpec(standard=standard, word=value[standard], law=_given(law), written=_as_text(value))
        if (text := typed_sizes(value)) is not None:
            return _of_sizes(text, value, law, "limits")
        lower, upper = _limits(stated)
    elif typed_sizes(value) is not None:
        return _of_sizes(value, value, law, "")
    else:
        lower, upper = _written(value, "")
    own = _given(law)
    return own.between(lower, upper).as_drawn(_as_text(value), own)


def typed_sizes(written: Any) -> str | None:
    """The text of limits of a size itself, such as `23.349 / 23.386 mm`; None of others."""
    text = written.get("limits") if isinstance(written, dict) else written
    return text if isinstance(text, str) and sizes_written(text) is not None else None


def _of_sizes(text: str, value: Any, law: LimitLaw | None, field: str) -> UnsizedSpec:
    try:
        size_limits(text, 0.0)
    except InputError as error:
        expected, _, got = str(error).removeprefix("expected ").partition(", got ")
        raise refused(field, expected, got) from None
    return UnsizedSpec(standard=SIZE, word=text, law=_given(law), written=_as_text(value))


def _given(law: LimitLaw | None) -> LimitLaw:
    if law is None:
        words = f'the key "{DEFAULT_LAW}" of the scene, such as "{DEFAULT_LAW}: {{kind: normal, sigmas: 3}}", by which '
        raise refused("", f"{words}limits without a law are read", "none; or write the law out, with kind:")
    return law


def restated(spec: DistributionSpec, law: Distribution) -> DistributionSpec:
    """Spec of another law of its kind, as it was written: in the same units, limits on a drawing as such limits.

    Args:
        spec: the law as a scene states it.
        law: the other one [mm, rad or K]; of limits on a drawing its middle is that of its limits.

    Raises:
        InputError: the law cannot be stated by numbers.
    """
    between: LimitLaw | None = spec.between
    if between is None:
        return spec.stating(law)
    told = spec.numbers(law)
    if (text := typed_sizes(spec.drawn)) is not None:
        own = resized(text, *(told[end] + nominal_of(spec) for end in ("lower", "upper")))
        ends = (spec.quantities()[end].like(told[end]) for end in ("lower", "upper"))
        drawn = {**spec.drawn, "limits": own} if isinstance(spec.drawn, dict) else own
        return between.between(*ends).as_drawn(drawn, between)
    written = rewritten(spec.drawn, told["lower"], told["upper"])
    limits = written["limits"] if isinstance(written, dict) else written
    return between.between(*_written(limits, "")).as_drawn(written, between)


def nominal_of(spec: DistributionSpec) -> float:
    """The nominal size [mm] from which a law by limits of a size counts."""
    pair = sizes_written(typed_sizes(spec.drawn))
    assert pair is not None
    return min(own.internal for own in pair) - spec.quantities()["lower"].internal


def rewritten(written: Any, lower: float, upper: float) -> Any:
    """Limits in the form and the units in which they were written; those of a standard as text, with their law.

    Args:
        written: text, a list or keys, as a drawing has them.
        lower, upper: the new limits [mm, rad or K]; they are written to ten digits.

    >>> rewritten("40.1 mm +0.12/0", -0.03, 0.15), rewritten("±20 um", -0.01, 0.025)
    ('40.1 mm +0.15/-0.03', '+25/-10 um')
    >>> rewritten({"fit": "H7", "of": "32 mm"}, 0.0, 0.0375)
    '+0.0375/0 mm'
    """
    if isinstance(written, dict):
        if "limits" in written:
            return {**written, "limits": rewritten(written["limits"], lower, upper)}
        if written.keys() & {"fit", "general"} and "of" in written:
            unit = Quantity.parse(written["of"])
        else:
            stated = _stated(written)
            unit = Quantity(0.0, "um") if isinstance(stated, Sized) else _limits(stated)[1]
        text = _text_of(lower, upper, unit)
        return {"limits": text, "law": written["law"]} if "law" in written else text
    if isinstance(written, list | tuple):
        own = [Quantity.parse(each) for each in written]
        ends = (lower, upper) if own[0].internal < own[1].internal else (upper, lower)
        return [str(each.like(end)) for each, end in zip(own, ends, strict=True)]
    return _rewritten_text(written, lower, upper)


def _rewritten_text(written: str, lower: float, upper: float) -> str:
    """Text of the same form; plus and minus only where both limits are as large."""
    first, second = _of_text(written, "")
    plain = written.translate(MINUS)
    if match := SYMMETRIC.fullmatch(plain):
        high, low = second.like(upper), second.like(lower)
        if high.number == -low.number:
            return f"{written[: match.start('size')]}{_number(high)}{written[match.end('size') :]}"
        return f"{written[: match.start('sign')]}{_signed(high)}/{_signed(low)}{written[match.end('size') :]}"
    match = TWO.fullmatch(plain)
    assert match is not None
    ends = (lower, upper) if first.internal < second.internal else (upper, lower)
    one, other = (_signed(each.like(end)) for each, end in zip((first, second), ends, strict=True))
    (start, middle), (begin, end) = match.span("one"), match.span("other")
    return f"{written[:start]}{one}{written[middle:begin]}{other}{written[end:]}"


def _text_of(lower: float, upper: float, unit: Quantity) -> str:
    high, low = unit.like(upper), unit.like(lower)
    if high.number == -low.number:
        return f"±{high}"
    return f"{_signed(high)}/{_signed(low)} {unit.unit}"


def _number(quantity: Quantity) -> str:
    return str(quantity).partition(" ")[0]


def _signed(quantity: Quantity) -> str:
    return f"{'+' if quantity.number > 0.0 else ''}{_number(quantity)}" if quantity.number else "0"


def limits_written(text: str) -> tuple[Quantity, Quantity] | None:
    """Lower and upper limit of text such as `±10 um`, `+0.02/0 mm` or `[-30 um, -19 um]`; None of any other text.

    Raises:
        InputError: a nominal size stands before them, a unit lacks, or they are alike.
    """
    if text.startswith("[") and text.endswith("]"):
        value: Any = [own.strip() for own in text[1:-1].split(",")]
    elif SYMMETRIC.fullmatch(text.translate(MINUS)) or TWO.fullmatch(text.translate(MINUS)):
        value = text
    else:
        return None
    if (nominal := nominal_size(value)) is not None:
        raise InputError(f"expected limits alone, got {text!r} with a nominal size; leave {nominal} out")
    try:
        return _written(value, "")
    except PydanticCustomError as error:
        raise InputError(str(error)) from None


def in_class(spec: DistributionSpec, tolerance_class: str, size: Quantity) -> DistributionSpec:
    """Limits on a drawing as those of a class of ISO 286 or DIN 3967, by the law that they have.

    Args:
        spec: limits as a drawing writes them.
        tolerance_class: such as H7 or cd25.
        size: nominal.
    """
    drawn = spec.drawn if isinstance(spec.drawn, dict) else {}
    between: LimitLaw = spec.between
    law = {"law": drawn["law"]} if "law" in drawn else {}
    if is_series(tolerance_class):
        written = {"din_3967": tolerance_class, **law}
        return UnsizedSpec(standard="din_3967", word=tolerance_class, law=between, written=written).of(size.internal)
    own = Quantity.parse(drawn["of"]) if "of" in drawn else None
    fit = {"fit": tolerance_class, "of": drawn["of"] if own == size else str(size)}
    written = {"din_3964": tolerance_class} if "din_3964" in drawn and is_field(tolerance_class) else fit
    written |= law
    return between.between(*_limits(FitSpec.model_validate(fit))).as_drawn(written, between)


def tolerated_size(written: Any) -> Quantity | None:
    """The size of limits: 32 mm of {fit: H7, of: 32 mm}, 40.1 mm of 40.1 mm +0.12/0; None where none is stated."""
    if isinstance(written, dict) and "of" in written and written.keys() & {"fit", "general"}:
        return Quantity.parse(written["of"])
    return nominal_size(written)


def nominal_size(written: Any) -> Quantity | None:
    """The number in front of limits, such as 40.1 mm of 40.1 mm +0.12/0; None where there is none."""
    text = written["limits"] if isinstance(written, dict) and "limits" in written else written
    match = isinstance(text, str) and (SYMMETRIC.fullmatch(own := text.translate(MINUS)) or TWO.fullmatch(own))
    if not match or match["nominal"] is None:
        return None
    return Quantity.parse(
        f"{match['nominal']} {match['nominal_unit'] or match['unit'] or match.groupdict().get('one_unit')}"
    )


def _as_text(value: Any) -> Any:
    """Value as YAML writes it; from Python it may hold quantities and a LimitLaw."""
    if isinstance(value, dict):
        return {key: _as_text(own) for key, own in value.items()}
    if isinstance(value, list | tuple):
        return [_as_text(own) for own in value]
    if isinstance(value, LimitLaw):
        return value.model_dump(exclude_unset=True)
    return str(value) if isinstance(value, Quantity) else value


def _stated(value: dict[str, Any]) -> Limited | Sized:
    key = next(key for key in KEYS if key in value)
    if key not in _SPECS:
        words = "limits, as in 0/+30 um, for the formulae of ISO 17485 (f_pt, F_p and F_r by the"
        raise refused(
            key, f"{words} tolerance diameter and the mean normal module) are not in tol3d", shown(value[key])
        )
    return _SPECS[key].model_validate(value)


def _limits(stated: Limited) -> tuple[Quantity, Quantity]:
    if isinstance(stated, LimitsSpec):
        return _written(stated.limits, "limits")
    field = next(key for key, own in _SPECS.items() if isinstance(stated, own))
    try:
        if isinstance(stated, FitSpec):
            lower, upper = iso_286.limits(stated.fit, stated.of.internal)
            return Quantity(float(lower), "um"), Quantity(float(upper), "um")
        if isinstance(stated, GradeSpec):
            word, _, grade = stated.iso_1328_2.strip().replace("″", "''").replace('"', "''").rpartition(" ")
            if not grade.isdecimal():
                raise InputError(f"expected a deviation and its grade, such as F_r 7, got {stated.iso_1328_2!r}")
            largest = iso_1328_2.tolerance(word.strip(), int(grade), stated.module.internal, stated.of.internal)
            return Quantity(0.0, "um"), Quantity(largest, "um")
        most = stated.limit
        return Quantity(-most.number, most.unit), most
    except InputError as error:
        expected, _, got = str(error).removeprefix("expected ").partition(", got ")
        raise refused(field, expected, got) from None


def _written(value: Any, field: str) -> tuple[Quantity, Quantity]:
    """Lower and upper limit of text or of a list of two."""
    pair = _of_list(value, field) if isinstance(value, list | tuple) else _of_text(value, field)
    dimensions = {own.dimension for own in pair}
    if len(dimensions) > 1:
        raise refused(field, "limits of one dimension", " and ".join(str(own) for own in pair))
    lower, upper = sorted(pair, key=lambda own: own.internal)
    if lower.internal == upper.internal:
        raise refused(field, "two different limits (for no spread at all write kind: constant)", shown(value))
    return lower, upper


def _of_list(value: Any, field: str) -> tuple[Quantity, Quantity]:
    if len(value) != 2:
        raise refused(field, "a lower and an upper limit, such as [-30 um, -19 um]", f"{len(value)} values")
    return _quantity(value[0], field), _quantity(value[1], field)


def _of_text(value: str, field: str) -> tuple[Quantity, Quantity]:
    if is_series(value):
        raise refused(field, f"{{din_3967: {value}}}", value)
    text = value.translate(MINUS) if len(value) <= LONGEST else ""
    if match := SYMMETRIC.fullmatch(text):
        unit = match["unit"] or match["nominal_unit"]
        size = _with_unit(match["size"], unit, value, field)
        return Quantity(-size.number, size.unit), size
    if match := TWO.fullmatch(text):
        unit = match["unit"] or match["one_unit"] or match["nominal_unit"]
        one = _with_unit(match["one"], match["one_unit"] or unit, value, field)
        return one, _with_unit(match["other"], unit, value, field)
    raise refused(field, WRITTEN, shown(value))


def _with_unit(number: str, unit: str | None, value: str, field: str) -> Quantity:
    if unit is None:
        raise refused(field, "a unit in it, such as ±0.1 mm", shown(value))
    return _quantity(f"{number} {unit}", field)


def _quantity(text: Any, field: str) -> Quantity:
    try:
        return Quantity.parse(text)
    except ValueError as error:
        raise refused(field, WRITTEN, str(error).removeprefix("got ")) from None
