"""The matrix of contributors and measures as a heat map: shares of a measure's total change."""

from pathlib import Path

import numpy as np

from tol3d.analyses.tolerance_effects import Effects
from tol3d.report.canvas import save_figure
from tol3d.report.heading import largest
from tol3d.report.heat_map import MOST_COLUMNS, MOST_ROWS, matrix_figure


def draw_effects(found: Effects, path: Path) -> None:
    """Draw changes over the whole tolerance, as shares of their sum for each measure.

    Raises:
        InputError: the picture cannot be written there.
    """
    names = list(found.measures)[:MOST_COLUMNS]
    changes = {
        name: {contributor: each.change or 0.0 for contributor, each in found.measures[name].contributors.items()}
        for name in names
    }
    percents = {
        name: {each: 100.0 * own / total if (total := sum(its.values())) > 0.0 else 0.0 for each, own in its.items()}
        for name, its in changes.items()
    }
    acting = list(dict.fromkeys(contributor for own in percents.values() for contributor in own))
    sums = {contributor: sum(own.get(contributor, 0.0) for own in percents.values()) for contributor in acting}
    shown = largest(sorted(acting, key=lambda contributor: -sums[contributor]), sums, MOST_ROWS)
    shares = np.array([[percents[name].get(contributor, np.nan) for name in names] for contributor in shown])
    head = [
        f"{found.scene}   ·   change over the whole tolerance",
        "in % of the sum of the changes by all contributors",
    ]
    if len(names) < len(found.measures):
        head.append(f"the first {len(names)} of {len(found.measures)} measures")
    if len(shown) < len(acting):
        head.append(f"the {len(shown)} largest of {len(acting)} contributors")
    save_figure(matrix_figure(shares.reshape(len(shown), len(names)), shown, names, head), path)
