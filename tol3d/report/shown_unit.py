"""The unit in which a measure is shown: lengths of assemblies over 1 mm in mm, their spread in um; files keep um."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, TypeVar

from tol3d.report.number import UM_PER_MM, UNIT_SIGNS
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.runs.summary.values import Section

T = TypeVar("T", bound=Section)

LONG_UM: Final = 1000.0 + 1e-6
"""A nominal length over this is shown in mm; what is 1 mm but for rounding is not."""
LENGTHS: Final = frozenset(
    (
        *("lower_limit", "upper_limit", "mean", "sigma", "low_3sigma", "high_3sigma", "sample_min", "sample_max"),
        *(
            "p0_135",
            "p50",
            "p99_865",
            "quantile_error",
            "deepest_overlap",
            "mean_se",
            "sigma_se",
            "mean_95",
            "sigma_95",
            "p0_135_95",
            "p99_865_95",
        ),
        *("pooled", "lower_edge", "bin_width", "max_abs_difference", "rms_difference", "mean_difference", "neglected"),
        *("second_order_rms", "second_order_mean", "left_rms", "mean_left", "mean_allowed"),
        *("expected_at_most", "allowance"),
    )
)
"""Keys of a measure's summary, and of sections in it, whose numbers are in its unit."""
BUILDS: Final = frozenset(("nominal", "mean_build"))
"""Keys of single builds: numbers of either method, or one that somebody published."""


@dataclass(frozen=True)
class Spread:
    """The unit of a measure's sigma and errors in a table: `factor` of it are one of the measure's."""

    unit: str
    factor: float = 1.0
    words: str = ""

    @classmethod
    def of(cls, measure: MeasureSummary) -> "Spread":
        """The unit um for a length that is shown in mm, as its label says; else the measure's own."""
        if measure.long_in_mm and measure.unit == "mm":
            return cls("um", UM_PER_MM, f" [{UNIT_SIGNS['um']}]")
        return cls(measure.unit)

    def times(self, value: float | None) -> float | None:
        """A value of the measure in this unit."""
        return None if value is None else self.factor * value


def shown_run(run: RunSummary) -> RunSummary:
    """A run as it is shown: long lengths of assemblies in mm, all else as it is."""
    long = {name: _in_mm(own) for name, own in run.measures.items() if own.long_in_mm and _is_long(own)}
    if not long:
        return run
    update: dict[str, Any] = {"measures": {**run.measures, **long}}
    if run.witness:
        again = {name: _scaled(own) if name in long else own for name, own in run.witness.measures.items()}
        update["witness"] = run.witness.model_copy(update={"measures": again})
    return run.model_copy(update=update)


def shown_unit(unit: str, nominal: float | None) -> str:
    """The unit in which a length of an assembly is shown.

    >>> shown_unit("um", 40220.0), shown_unit("um", -1000.0), shown_unit("arcmin", 5400.0), shown_unit("um", None)
    ('mm', 'um', 'arcmin', 'um')
    """
    return "mm" if unit == "um" and nominal is not None and abs(nominal) > LONG_UM else unit


def _is_long(measure: MeasureSummary) -> bool:
    """By its nominal value; where there is none, by its mean."""
    sample = measure.sample("analytic")
    known = (measure.nominal.analytic, measure.nominal.geometric, sample.mean if sample else None)
    nominal = next((own for own in known if isinstance(own, float)), None)
    return shown_unit(measure.unit, nominal) != measure.unit


def _in_mm(measure: MeasureSummary) -> MeasureSummary:
    return _scaled(measure).model_copy(update={"unit": "mm"})


def _scaled(own: T) -> T:
    """A section with its lengths in mm instead of um, those of sections in it too."""
    known = {name: value for name, value in vars(own).items() if name in own.model_fields_set}
    return own.model_copy(update={name: _of_key(name, value) for name, value in known.items()})


def _of_key(name: str, value: Any) -> Any:
    if isinstance(value, Section):
        if name in BUILDS:
            return value.model_copy(update={method: _length(own) for method, own in vars(value).items()})
        return _scaled(value)
    if isinstance(value, Mapping):
        lengths = name in LENGTHS
        return {k: _scaled(v) if isinstance(v, Section) else _length(v) if lengths else v for k, v in value.items()}
    if name not in LENGTHS and name not in BUILDS:
        return value
    return [_length(each) for each in value] if isinstance(value, list) else _length(value)


def _length(value: Any) -> Any:
    return value / UM_PER_MM if isinstance(value, int | float) else value
