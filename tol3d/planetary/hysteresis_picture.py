"""The chart of a torque curve."""

from pathlib import Path

import numpy as np

from tol3d.planetary.hysteresis import ARCMIN, Hysteresis
from tol3d.planetary.summary_types import TorqueCurve
from tol3d.report.chart import Chart, Charts, Line, Mark, Panel
from tol3d.report.chart_figure import save_charts
from tol3d.report.measure_charts import spanned


def draw_hysteresis(found: Hysteresis, path: Path) -> None:
    """Draw its chart; .png, .svg or .pdf.

    Raises:
        InputError: the picture cannot be written there.
    """
    save_charts(Charts([[hysteresis_chart(found)]]), path)


def hysteresis_chart(found: Hysteresis) -> Chart:
    """Turn against torque, with the breakaway torques and the dead band of a rigid carrier."""
    turns = np.array(found.minutes)
    rigid = [] if found.rigid is None else [end / ARCMIN for end in found.rigid]
    band = f"rigid carrier: dead band {rigid[1] - rigid[0]:.2f}′" if rigid else ""
    marks = [Mark(end, "guide", upright=False, label=band) for end in rigid]
    ends = [end for end in found.breakaway if np.isfinite(end)]
    words = f"breakaway at {' and '.join(f'{end:.0f}' for end in ends)} N mm"
    marks += [Mark(end, "guide", label=words, role="series-1") for end in ends]
    x = spanned(f"torque on {found.shaft}", np.array([*found.torques, *ends]), "N mm")
    y = spanned(f"turn of {found.shaft}", np.array([*turns, *rigid]), "′")
    curve = Line(found.torques, turns, "series-0", "flexible carrier, there and back")
    table = [*([("rigid carrier", band)] if rigid else []), *([("breakaway", words)] if ends else [])]
    return Chart(
        f"turn of {found.shaft} against torque", x, [Panel(y, [curve], marks, 1.5)], "torque against turn", table=table
    )


def draw_curve(kept: TorqueCurve, path: Path) -> None:
    """Its picture; see draw_hysteresis."""
    rigid = None if kept.rigid_arcmin is None else (kept.rigid_arcmin[0] * ARCMIN, kept.rigid_arcmin[1] * ARCMIN)
    torques, turns = np.array(kept.torque_n_mm), np.array(kept.turn_arcmin) * ARCMIN
    breakaway = kept.breakaway_n_mm[0], kept.breakaway_n_mm[1]
    draw_hysteresis(Hysteresis(kept.shaft, torques, turns, breakaway, rigid), path)
