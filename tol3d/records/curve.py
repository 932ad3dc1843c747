"""The backlash over the long period: predicted, and measured where both sides have rows."""

import csv
import io
from dataclasses import dataclass

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.records.exact_play import Side
from tol3d.records.findings import Identified
from tol3d.records.fit import Fit
from tol3d.records.pair import ARCSEC
from tol3d.records.spectrum import with_tooth_mesh


@dataclass(frozen=True, eq=False)
class BacklashCurve:
    """Over positions of the driver.

    Args:
        phi1: (n,) [rad], over the long period, its end included.
        predicted, half_width: (n,) [rad].
        measured: (n,) [rad]; nan where a side has no rows.
    """

    phi1: Array
    predicted: Array
    half_width: Array
    measured: Array

    def csv(self) -> str:
        """Comma-separated values in degrees and arc seconds; nothing where nothing was measured."""
        stream = io.StringIO()
        writer = csv.writer(stream, lineterminator="\n")
        columns = ("predicted", "lower 95 %", "upper 95 %", "measured")
        writer.writerow(["phi1 [deg]", *(f"{name} [arcsec]" for name in columns)])
        for at, own, wide, seen in zip(self.phi1, self.predicted, self.half_width, self.measured, strict=True):
            ends = (own, own - wide, own + wide)
            measured = "" if np.isnan(seen) else f"{seen / ARCSEC:.6f}"
            writer.writerow([f"{np.degrees(at):.6f}", *(f"{value / ARCSEC:.6f}" for value in ends), measured])
        return stream.getvalue()


def curve_of(found: Identified) -> BacklashCurve:
    """The curve at the positions of the prediction.

    TE_drive + j = TE_back + j_0: what either side's rows about a position leave of its fitted curve moves the measured
    backlash away from the predicted one, so that sides need not be sampled at the same places.
    """
    phi1 = found.model.positions
    predicted = found.model.backlash(phi1)
    drive, back = (_left(found.fit, side, len(phi1) - 1) for side in found.fit.terms.sides)
    measured = predicted[:-1] + back - drive
    return BacklashCurve(phi1, predicted, found.model.half_width(phi1), np.append(measured, measured[0]))


def _left(fit: Fit, side: Side, positions: int) -> Array:
    """Mean of what eccentricities leave of the rows about each position (positions,) [rad]; nan where none are."""
    step = fit.measured.pair.long_period / positions
    index = np.round(fit.measured.points[side].phi1 / step).astype(np.int64) % positions
    rows = np.bincount(index, fit.measured.rows[side], minlength=positions)
    total = np.bincount(index, fit.measured.rows[side] * with_tooth_mesh(fit, side), minlength=positions)
    return np.where(rows > 0, total / np.maximum(rows, 1.0), np.nan)
