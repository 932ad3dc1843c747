"""The spectrum of a curve as a table: amplitudes of its harmonics, the largest of them where there are many."""

from collections.abc import Iterator, Mapping

from tol3d.report.column import heading_by
from tol3d.report.number import UNIT_SIGNS, value_cell
from tol3d.report.page import PageItem, Row, Table, note
from tol3d.report.published import spectrum_columns
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.sample import CurveMethods, SpectrumSample
from tol3d.study.runs.summary.values import Method

ORDER_ROWS = 12  # orders that are printed; summary.json has them all
MEANING = "amplitudes of each trial's curve, half of peak to peak; order: cycles per turn"


def spectrum_blocks(measure: MeasureSummary, curve: CurveMethods) -> Iterator[PageItem]:
    """The table and its notes; nothing of a curve without a spectrum."""
    found = {method: own.spectrum for method, own in curve.by_method.items() if own.spectrum is not None}
    if not found:
        return
    yield _table(measure, found)
    leading = [*found.values()][-1]
    left_out = len(leading.order) - len(largest_orders(leading))
    yield note(f"{MEANING}; {left_out} smaller ones in summary.json" if left_out else MEANING)


def _table(measure: MeasureSummary, found: Mapping[Method, SpectrumSample]) -> Table:
    words = {"analytic": "analytic", "geometric": "3D"}
    leading = [*found.values()][-1]
    columns = [
        (heading_by(key, f"{words[key]} {word}"), values) for key, own in found.items() for word, values in _values(own)
    ]
    columns += [(heading_by("published", text), values) for text, values in spectrum_columns(measure, leading.order)]
    rows = [
        Row(
            f"{leading.order[k]:g}",
            [value_cell(values[k], measure.unit) for _, values in columns],
            unit=measure.unit,
        )
        for k in largest_orders(leading)
    ]
    unit = "" if measure.unit == "arcmin" else f" [{UNIT_SIGNS[measure.unit]}]"  # an angle's cells have their signs
    return Table(f"amplitude{unit} of order", [heading for heading, _ in columns], rows)


def _values(spectrum_sample: SpectrumSample) -> Iterator[tuple[str, list[float | None]]]:
    yield "mean", spectrum_sample.mean
    yield "p50", spectrum_sample.p50
    yield "p99.865", spectrum_sample.p99_865


def largest_orders(spectrum_sample: SpectrumSample) -> list[int]:
    """Which orders are printed: the largest by their means, in ascending order."""
    by_size = sorted(range(len(spectrum_sample.order)), key=lambda k: -(spectrum_sample.mean[k] or 0.0))
    return sorted(by_size[:ORDER_ROWS])
