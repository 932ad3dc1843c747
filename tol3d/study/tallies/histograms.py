"""Histograms of both methods over the same bars."""

from tol3d.study.runs.summary.sample import Histogram
from tol3d.study.runs.summary.values import Method, made
from tol3d.study.tallies.sample import Sample
from tol3d.study.tallies.tally import MeasureTally

HISTOGRAM_BINS = 64  # bars kept in summary.json for pictures


def histograms(tally: MeasureTally) -> Histogram:
    """Counts of both methods over the same bars, for pictures; in the measure's unit."""
    samples: dict[Method, Sample] = {"analytic": tally.analytic}
    if tally.geometric:
        samples["geometric"] = tally.geometric
    filled = [sample.moments for sample in samples.values() if sample.moments.count]
    if not filled:
        return made(Histogram)
    span = (min(m.minimum for m in filled), max(m.maximum for m in filled))
    drawn = {method: sample.grid.histogram(HISTOGRAM_BINS, span) for method, sample in samples.items()}
    edges = drawn["analytic"].edges
    return made(
        Histogram,
        lower_edge=float(edges[0]),
        bin_width=float(edges[1] - edges[0]),
        counts={method: histogram.counts.tolist() for method, histogram in drawn.items()},
    )
