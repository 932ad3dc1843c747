"""The torque curve of a set on a flexible carrier, as a run keeps it."""

from pathlib import Path

import numpy as np

from tol3d.planetary.hysteresis import ARCMIN, Hysteresis
from tol3d.planetary.hysteresis_picture import draw_hysteresis
from tol3d.planetary.summary_types import TorqueCurve


def draw_curve(kept: TorqueCurve, path: Path) -> None:
    """Its picture; see draw_hysteresis."""
    rigid = None if kept.rigid_arcmin is None else (kept.rigid_arcmin[0] * ARCMIN, kept.rigid_arcmin[1] * ARCMIN)
    torques, turns = np.array(kept.torque_n_mm), np.array(kept.turn_arcmin) * ARCMIN
    breakaway = kept.breakaway_n_mm[0], kept.breakaway_n_mm[1]
    draw_hysteresis(Hysteresis(kept.shaft, torques, turns, breakaway, rigid), path)
