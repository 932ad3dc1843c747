"""Difference of both methods, trial by trial, as SVG."""

from tol3d.report.compare import Difference
from tol3d.report.comparison_picture import DIFFERENCE_UNITS
from tol3d.report.html.axis import Axis, Frame, below, beside, chart
from tol3d.report.html.tags import Markup, tag
from tol3d.runs.summary.measure import MeasureSummary

TOP, BOTTOM, FOOT = 14.0, 170.0, 44.0


def difference_chart(measure: MeasureSummary, own: Difference, frame: Frame) -> Markup:
    """The histogram of the 3D simulation less the analytic method."""
    unit, factor = DIFFERENCE_UNITS[measure.unit]
    bars = own.bars.times(factor)
    x = frame.across(float(bars.edges[0]), float(bars.edges[-1]))
    y = Axis(0.0, 1.05 * float(bars.counts.max()) or 1.0, start=BOTTOM, end=TOP)
    inside = [
        *below(x, TOP, BOTTOM, f"3D simulation − analytic, trial by trial [{unit}]"),
        *beside(y, frame, "trials"),
    ]
    for k, count in enumerate(bars.counts):
        if count:
            low, high = float(bars.edges[k]), float(bars.edges[k + 1])
            words = f"{low:.4g} to {high:.4g} {unit}: {count:.0f} trials"
            left, top = x(low), y(float(count))
            inside.append(
                tag(
                    "rect",
                    tag("title", words),
                    x=left,
                    y=top,
                    width=x(high) - left,
                    height=BOTTOM - top,
                    class_="geometric",
                )
            )
    return chart(frame, "difference of both methods", BOTTOM + FOOT, *inside)
