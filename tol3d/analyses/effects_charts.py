"""The matrix of contributors and measures as a chart: shares of a measure's total change."""

from tol3d.analyses.tolerance_effects import Effects
from tol3d.report.chart import Chart, Charts
from tol3d.report.share_charts import matrix


def effects_chart(found: Effects) -> Chart:
    """Changes over the whole tolerance, as shares of their sum for each measure."""
    changes = {
        name: {contributor: each.change or 0.0 for contributor, each in own.contributors.items()}
        for name, own in found.measures.items()
    }
    percents = {
        name: {each: 100.0 * own / total if (total := sum(its.values())) > 0.0 else 0.0 for each, own in its.items()}
        for name, its in changes.items()
    }
    title = f"{found.scene}   ·   change over the whole tolerance"
    words = "change over the whole tolerance, in % of the sum of the changes by all contributors"
    return matrix(percents, title, words, what="changes over the whole tolerances")


def effects_charts(found: Effects) -> Charts:
    """The matrix alone."""
    return Charts([[effects_chart(found)]])
