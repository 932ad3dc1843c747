"""The chart of a torque curve."""

from pathlib import Path

import numpy as np

from tol3d.gearing.planetary.summary_types import TorqueCurve
from tol3d.report.chart import Chart, Charts, Line, Mark, Panel
from tol3d.report.chart_figure import save_charts
from tol3d.report.measure_charts import spanned


def draw_curve(curve: TorqueCurve, path: Path) -> None:
    """Draw its chart; .png, .svg or .pdf.

    Raises:
        InputError: the picture cannot be written there.
    """
    save_charts(Charts([[curve_chart(curve)]]), path)


def curve_chart(curve: TorqueCurve) -> Chart:
    """Turn against torque, with the breakaway torques and the dead band of a rigid carrier."""
    torques, turns, rigid = np.array(curve.torque_n_mm), np.array(curve.turn_arcmin), curve.rigid_arcmin or ()
    band = f"rigid carrier: dead band {rigid[1] - rigid[0]:.2f}′" if rigid else ""
    marks = [Mark(end, "guide", upright=False, label=band) for end in rigid]
    ends = [end for end in curve.breakaway_n_mm if np.isfinite(end)]
    words = f"breakaway at {' and '.join(f'{end:.0f}' for end in ends)} N mm"
    marks += [Mark(end, "guide", label=words, role="series-1") for end in ends]
    x = spanned(f"torque on {curve.shaft}", np.array([*torques, *ends]), "N mm")
    y = spanned(f"turn of {curve.shaft}", np.array([*turns, *rigid]), "′")
    line = Line(torques, turns, "series-0", "flexible carrier, there and back")
    table = [*([("rigid carrier", band)] if rigid else []), *([("breakaway", words)] if ends else [])]
    return Chart(
        f"turn of {curve.shaft} against torque", x, [Panel(y, [line], marks, 1.5)], "torque against turn", table=table
    )
