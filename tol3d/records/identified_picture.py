"""Pictures of an identification: the backlash over the long period, and the residual of the fit."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.axes import Axes

from tol3d.numerics.arrays import Array
from tol3d.records.findings import Identified
from tol3d.records.fit import Fit
from tol3d.records.pair import ARCSEC, TURN, Side
from tol3d.records.spectrum import with_tooth_mesh
from tol3d.report.canvas import BLACK, BLUE, GREY, ORANGE, VERMILLION, legend_below, new_figure, plain_axes, save_figure
from tol3d.runs.csv_text import csv_text


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


WIDTH: Final = 11.0  # inch
HEIGHT: Final = 5.6
COLOURS: Final = {"drive": BLUE, "back": ORANGE}
LEAST_SHOWN: Final = 1e-3  # arc seconds, of a spectrum on a logarithmic axis


def draw_backlash(found: Identified, curve: BacklashCurve, path: Path) -> None:
    """Backlash of the eccentricities and as measured, its ends marked; `path` ends in .png, .svg or .pdf.

    Raises:
        InputError: the picture cannot be written there.
    """
    figure = new_figure(WIDTH, HEIGHT)
    axes = plain_axes(figure.subplots())
    turns, predicted = curve.phi1 / TURN, curve.predicted / ARCSEC
    wide = curve.half_width / ARCSEC
    axes.plot(turns, curve.measured / ARCSEC, ".", color=GREY, markersize=2.5, label="measured, both sides")
    axes.fill_between(turns, predicted - wide, predicted + wide, color=BLUE, alpha=0.3, linewidth=0)
    label = f"of the eccentricities alone, 95 % interval at most ±{float(wide.max()):.2f}″ at a position"
    axes.plot(turns, predicted, color=BLUE, linewidth=1.4, label=label)
    for word, own in (("least", found.whole.least), ("largest", found.whole.largest)):
        at, value = own.place.value / TURN, own.backlash.value / ARCSEC
        half = own.backlash.half_width / ARCSEC
        text = f"{word} {value:.2f} ±{half:.2f}″ at {np.degrees(own.place.value):.1f}°"
        axes.plot([at], [value], "o", color=VERMILLION, markersize=7, label=text)
    axes.set_xlim(0.0, float(turns[-1]))
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    axes.set_xlabel("turns of the driver", fontsize=10)
    axes.set_ylabel("angular backlash of the driven gear [″]", fontsize=10)
    axes.set_title("backlash over the long period", loc="left", fontsize=12, fontweight="bold", color=BLACK)
    legend_below(axes)
    save_figure(figure, path)


def draw_residual(found: Identified, path: Path) -> None:
    """Draw the residual of the fit over the long period, and its spectrum.

    Raises:
        InputError: the picture cannot be written there.
    """
    figure = new_figure(WIDTH, 1.5 * HEIGHT)
    upper, lower = figure.subplots(2, 1)
    _draw_over_turns(plain_axes(upper), found)
    _draw_spectrum(plain_axes(lower), found)
    save_figure(figure, path)


def _draw_over_turns(axes: Axes, found: Identified) -> None:
    for side in found.fit.terms.sides:
        at = found.fit.measured.points[side].phi1 / TURN
        left = found.fit.residual[side] / ARCSEC
        axes.plot(at, left, ".", color=COLOURS[side], markersize=1.5, alpha=0.6, label=f"{side} side", rasterized=True)
    axes.set_xlim(0.0, float(found.pair.long_period_turns))
    axes.set_xlabel("turns of the driver", fontsize=10)
    axes.set_ylabel("what the fit leaves [″]", fontsize=10)
    axes.set_title("residual, means of position bins", loc="left", fontsize=12, fontweight="bold", color=BLACK)
    axes.legend(fontsize=8.5, frameon=True, framealpha=0.85, edgecolor="none", markerscale=5, loc="upper right")


def _draw_spectrum(axes: Axes, found: Identified) -> None:
    spectrum = found.spectrum
    for side, amplitudes in spectrum.amplitudes.items():
        shown = np.maximum(amplitudes[1:] / ARCSEC, LEAST_SHOWN)
        axes.plot(spectrum.orders[1:], shown, color=COLOURS[side], linewidth=0.8, label=f"{side} side")
    noise = max(spectrum.lines[0].noise.values()) / ARCSEC
    axes.axhline(noise, color=GREY, linewidth=1.0, linestyle="--", label="white noise, exceeded by one line of twenty")
    for order in (1.0, found.pair.rate, float(found.pair.driver_teeth), 2.0 * found.pair.driver_teeth):
        axes.axvline(order, color=GREY, linewidth=0.8, linestyle=":", zorder=0)
    axes.set(xscale="log", yscale="log", xlim=(float(spectrum.orders[1]), float(spectrum.orders[-1])))
    axes.set_xlabel("order of the driver's turn (dotted: both gears' turns, tooth mesh and twice that)", fontsize=10)
    axes.set_ylabel("amplitude [″]", fontsize=10)
    axes.set_title("spectrum of the residual, with tooth mesh", loc="left", fontsize=12, fontweight="bold", color=BLACK)
    axes.legend(fontsize=8.5, frameon=True, framealpha=0.85, edgecolor="none", loc="lower left")
