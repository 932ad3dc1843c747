"""The slow reference: each trial by itself, gaps by plain trigonometry, the slide by a linear programme."""

import math
from collections.abc import Sequence

import numpy as np
from scipy.optimize import linprog


def gaps_of(radius: float, room: float, pins: Sequence[float], off: tuple[float, float]) -> list[float]:
    """Gap of each pin [mm]."""
    found = []
    for k, own in enumerate(pins):
        angle = 2 * math.pi * (k + 0.25) / len(pins)
        reach = math.dist((radius * math.cos(angle), radius * math.sin(angle)), off)
        found.append(room + own + reach - radius)
    return found


def slide_of(gaps: Sequence[float], steepest: float) -> float:
    """The longest slide [mm]: furthest end less nearest, each held by the pins before it."""
    rows, bounds = [], []
    for k, gap in enumerate(gaps):
        cos = math.cos(2 * math.pi * (k + 0.25) / len(gaps))
        if abs(cos) > steepest:
            rows.append([cos, 0.0] if cos > 0 else [0.0, cos])
            bounds.append(gap)
    solved = linprog([-1.0, 1.0], A_ub=np.array(rows), b_ub=bounds, bounds=[(None, None)] * 2)
    assert solved.success
    return float(-solved.fun)
