"""Charts of an identification: the backlash over the long period, and the residual of the fit."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from tol3d.apps.records.findings import Identified
from tol3d.apps.records.fit import Fit
from tol3d.apps.records.pair import ARCSEC, TURN, Side
from tol3d.apps.records.spectrum import with_tooth_mesh
from tol3d.numerics.arrays import Array
from tol3d.report import save_charts, spanned
from tol3d.report.chart import Axis, Band, Chart, Charts, Line, Mark, Panel, Points, Role, Series
from tol3d.study.runs.csv_text import csv_text


@dataclass(frozen=True, eq=False)
class BacklashCurve:
    """Backlash over positions of the driver.

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
        """Comma-separated values in degrees and arc seconds; empty where nothing was measured."""
        columns = ("predicted", "lower 95 %", "upper 95 %", "measured")
        rows = [["phi1 [deg]", *(f"{name} [arcsec]" for name in columns)]]
        for at, own, wide, seen in zip(self.phi1, self.predicted, self.half_width, self.measured, strict=True):
            ends = (own, own - wide, own + wide)
            measured = "" if np.isnan(seen) else f"{seen / ARCSEC:.6f}"
            rows.append([f"{np.degrees(at):.6f}", *(f"{value / ARCSEC:.6f}" for value in ends), measured])
        return csv_text(rows)


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
    """Mean residual of eccentricities in the rows about each position (positions,) [rad]; nan where none are."""
    step = fit.measured.pair.long_period / positions
    index = np.round(fit.measured.points[side].phi1 / step).astype(np.int64) % positions
    rows = np.bincount(index, fit.measured.rows[side], minlength=positions)
    total = np.bincount(index, fit.measured.rows[side] * with_tooth_mesh(fit, side), minlength=positions)
    return np.where(rows > 0, total / np.maximum(rows, 1.0), np.nan)


SIDES: Final[Mapping[Side, Role]] = {"drive": "series-0", "back": "series-1"}
LEAST_SHOWN: Final = 1e-3  # arc seconds, of a spectrum on a logarithmic axis


def draw_backlash(found: Identified, curve: BacklashCurve, path: Path) -> None:
    """Backlash of the eccentricities and as measured, its ends marked; `path` ends in .png, .svg or .pdf.

    Raises:
        InputError: the picture cannot be written there.
    """
    save_charts(Charts([[backlash_chart(found, curve)]], width=11.0), path)


def backlash_chart(found: Identified, curve: BacklashCurve) -> Chart:
    """Backlash over the long period: of the eccentricities with its interval, as measured, and its ends."""
    turns, predicted = curve.phi1 / TURN, curve.predicted / ARCSEC
    measured, wide = curve.measured / ARCSEC, curve.half_width / ARCSEC
    series: list[Series] = [
        Points(turns, measured, "soft", "measured, both sides", "speck"),
        Band(turns, predicted - wide, predicted + wide, "series-0"),
    ]
    label = f"of the eccentricities alone, 95 % interval at most ±{float(wide.max()):.2f}″ at a position"
    series.append(Line(turns, predicted, "series-0", label))
    table = []
    for word, own in (("least", found.whole.least), ("largest", found.whole.largest)):
        at, value = own.place.value / TURN, own.backlash.value / ARCSEC
        half = own.backlash.half_width / ARCSEC
        words = f"{value:.2f} ±{half:.2f}″ at {np.degrees(own.place.value):.1f}°"
        series.append(Points(np.array([at]), np.array([value]), "series-5", f"{word} {words}"))
        table.append((word, words))
    y = spanned("angular backlash of the driven gear", np.concatenate([measured, predicted - wide, predicted + wide]))
    y = replace(y, low=min(0.0, y.low), unit="″")
    across = Axis("turns of the driver", 0.0, float(turns[-1]))
    title = "backlash over the long period"
    return Chart(title, across, [Panel(y, series, height=1.4)], title, table=table)


def draw_residual(found: Identified, path: Path) -> None:
    """Draw the residual of the fit over the long period, and its spectrum.

    Raises:
        InputError: the picture cannot be written there.
    """
    save_charts(Charts([[residual_chart(found)], [spectrum_chart(found)]], width=11.0), path)


def residual_chart(found: Identified) -> Chart:
    """The residual of the fit in bins of positions."""
    sides = found.fit.terms.sides
    series = [
        Points(
            found.fit.measured.points[side].phi1 / TURN,
            found.fit.residual[side] / ARCSEC,
            SIDES[side],
            f"{side} side",
            "speck",
        )
        for side in sides
    ]
    y = spanned("what the fit leaves", np.concatenate([own.y for own in series]), "″")
    across = Axis("turns of the driver", 0.0, float(found.pair.long_period_turns))
    return Chart("residual of the fit over positions", across, [Panel(y, series)], "residual, means of position bins")


def spectrum_chart(found: Identified) -> Chart:
    """Amplitudes of the residual over orders, with the level of noise and the orders of turns and tooth mesh."""
    spectrum = found.spectrum
    orders = spectrum.orders[1:]
    series = [
        Line(orders, np.maximum(own[1:] / ARCSEC, LEAST_SHOWN), SIDES[side], f"{side} side", "thin")
        for side, own in spectrum.amplitudes.items()
    ]
    noise = max(spectrum.lines[0].noise.values()) / ARCSEC
    places = (1.0, found.pair.rate, float(found.pair.driver_teeth), 2.0 * found.pair.driver_teeth)
    words = "white noise, exceeded by one line of twenty"
    marks = [
        Mark(noise, "guide", upright=False, label=words, role="soft"),
        *(Mark(order, "guide", label="both gears' turns, tooth mesh and twice that") for order in places),
    ]
    highest = max(float(own.y.max()) for own in series)
    y = Axis("amplitude", min(float(own.y.min()) for own in series) / 1.5, 1.5 * max(highest, noise), "″", log=True)
    across = Axis("order of the driver's turn", float(orders[0]), float(orders[-1]), log=True)
    title = "spectrum of the residual, with tooth mesh"
    return Chart(title, across, [Panel(y, series, marks)], title, table=[("noise", f"{noise:.3g}″")])
