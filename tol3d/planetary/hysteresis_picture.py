"""The picture of a torque curve."""

from pathlib import Path
from typing import Final

import numpy as np

from tol3d.planetary.hysteresis import ARCMIN, Hysteresis
from tol3d.planetary.summary_types import TorqueCurve
from tol3d.report.canvas import BLACK, BLUE, GREY, ORANGE, legend_below, new_figure, plain_axes, save_figure

WIDTH: Final = 9.0  # inch
HEIGHT: Final = 5.6


def draw_hysteresis(found: Hysteresis, path: Path) -> None:
    """Turn against torque, with the breakaway torques and the dead band of a rigid carrier; .png, .svg or .pdf.

    Raises:
        InputError: the picture cannot be written there.
    """
    figure = new_figure(WIDTH, HEIGHT)
    axes = plain_axes(figure.subplots())
    rigid = [] if found.rigid is None else list(found.rigid)
    for place, end in enumerate(rigid):
        label = f"rigid carrier: dead band {(rigid[1] - rigid[0]) / ARCMIN:.2f}′" if not place else None
        axes.axhline(end / ARCMIN, color=GREY, linewidth=1.0, linestyle="--", label=label)
    ends = [end for end in found.breakaway if np.isfinite(end)]
    words = " and ".join(f"{end:.0f}" for end in ends)
    for place, end in enumerate(ends):
        label = f"breakaway at {words} N mm" if not place else None
        axes.axvline(end, color=ORANGE, linewidth=1.0, label=label)
    axes.plot(found.torques, found.minutes, color=BLUE, linewidth=1.6, label="flexible carrier, there and back")
    axes.set_xlabel(f"torque on {found.shaft} [N mm]", fontsize=10)
    axes.set_ylabel(f"turn of {found.shaft} [′]", fontsize=10)
    axes.set_title("torque against turn", loc="left", fontsize=12, fontweight="bold", color=BLACK)
    legend_below(axes)
    save_figure(figure, path)


def draw_curve(kept: TorqueCurve, path: Path) -> None:
    """Its picture; see draw_hysteresis."""
    rigid = None if kept.rigid_arcmin is None else (kept.rigid_arcmin[0] * ARCMIN, kept.rigid_arcmin[1] * ARCMIN)
    torques, turns = np.array(kept.torque_n_mm), np.array(kept.turn_arcmin) * ARCMIN
    breakaway = kept.breakaway_n_mm[0], kept.breakaway_n_mm[1]
    draw_hysteresis(Hysteresis(kept.shaft, torques, turns, breakaway, rigid), path)
