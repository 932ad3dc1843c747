"""Contents of identified.json, as `identify` writes it: documented keys with their units."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from tol3d.apps.records.findings import Identified
from tol3d.apps.records.pair import ARCSEC, TURN, Side
from tol3d.apps.records.prediction import Figure, OneSided
from tol3d.apps.records.scene_mesh import SceneMesh

Unit = Literal["um", "deg", "arcsec", "arcsec/(N m)"]

UNITS: Mapping[str, tuple[Unit, float]] = {
    "e1": ("um", 1e-3),
    "theta1": ("deg", math.pi / 180),
    "e2": ("um", 1e-3),
    "theta2": ("deg", math.pi / 180),
    "jc": ("arcsec", ARCSEC),
    "j0": ("arcsec", ARCSEC),
    "jmin": ("arcsec", ARCSEC),
    "jmin at": ("deg", math.pi / 180),
    "jmax": ("arcsec", ARCSEC),
    "jmax at": ("deg", math.pi / 180),
    "jmin eccentric": ("arcsec", ARCSEC),
    "jmin eccentric at": ("deg", math.pi / 180),
    "jmax eccentric": ("arcsec", ARCSEC),
    "jmax eccentric at": ("deg", math.pi / 180),
}
"""Unit of each figure, and one of it in mm or rad."""


class Kept(BaseModel):
    """A part of the file; no other keys."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class FigureSummary(Kept):
    """A number with its 95 % interval: value ± half_width."""

    value: float
    half_width: float
    unit: Unit


class PairSummary(Kept):
    """The pair by its scene."""

    scene: str
    mesh: str
    driver_teeth: int
    driven_teeth: int
    centre_distance_mm: float = Field(description="held at the mean of the scene's tolerances, as all of the pair is")
    working_pressure_angle_deg: float
    long_period_turns: int = Field(description="of the driver")
    in_bores: list[str] = Field(description="its shafts that lie in the bores of a housing, at the means of these")


class PassSummary(Kept):
    """One pass of a file."""

    file: str
    repeat: int = Field(description="0 if the file has no such column")
    rows: int
    turns: float = Field(description="of the driver")
    shifted_by_turns: int = Field(description="of the driver, to lie where it belongs in the long period")
    torque_least_n_m: float | None
    torque_largest_n_m: float | None


class SideSummary(Kept):
    """One side, and the findings from it alone."""

    passes: list[PassSummary]
    alone: dict[str, FigureSummary]
    apart: float = Field(description="largest difference from the joint fit, in standard errors of the difference")
    disagrees: bool = Field(description="by more than three of them")


class OrderSummary(Kept):
    """A line of the spectrum of the residual, tooth mesh included; amplitudes by side."""

    order: str = Field(description="per turn of the driver, as a fraction")
    words: str
    amplitude_arcsec: dict[str, float]
    noise_arcsec: float = Field(description="that white noise exceeds in one case of twenty")


class ResidualSummary(Kept):
    """Residual of the fit."""

    sigma_arcsec: float = Field(description="standard deviation of one row about the fit")
    noise_arcsec: float = Field(description="the same about its neighbours: teeth aside")
    low_orders: float = Field(
        description="strength at low orders, pitches aside, over white noise; it widens intervals"
    )
    tooth_orders_fitted: list[int]
    drift_fitted: bool
    orders: list[OrderSummary]


class IdentifiedSummary(Kept):
    """identified.json; angles of phi1, phi2, theta1, theta2 in each gear's own sense of rotation in the drive run."""

    format: Literal["tol3d identified 1"] = "tol3d identified 1"
    pair: PairSummary
    encoder_senses: list[int] = Field(description="of encoders 1 and 2: +1 where they count in the gear's own sense")
    figures: dict[str, FigureSummary] = Field(description="of both sides together: " + ", ".join(UNITS))
    measured: bool = Field(
        description="whether both sides cover the long period, so that j0, jmin and jmax are measured, not predicted"
    )
    encoders: dict[str, FigureSummary] = Field(description="once per turn, in each encoder's own angle")
    encoders_twice: dict[str, FigureSummary] = Field(description="twice per turn, of encoders of which rows tell it")
    closure: dict[str, FigureSummary] = Field(
        description="change over the long period of the transmission error of drive and back, and of the backlash; "
        "empty where a side is shorter"
    )
    winding: FigureSummary | None = Field(description="1/k of B(T) = j + T/k; null where torque does not vary")
    sides: dict[str, SideSummary]
    residual: ResidualSummary
    warnings: list[str]


def summary_of(found: Identified, own: SceneMesh) -> IdentifiedSummary:
    """Findings in the form in which they are kept."""
    pair = found.pair
    return IdentifiedSummary(
        pair=PairSummary(
            scene=own.scene,
            mesh=own.mesh.name,
            driver_teeth=pair.driver_teeth,
            driven_teeth=pair.driven_teeth,
            centre_distance_mm=pair.centre_distance,
            working_pressure_angle_deg=math.degrees(pair.working_angle),
            long_period_turns=pair.long_period_turns,
            in_bores=list(own.builds.in_bores),
        ),
        encoder_senses=[found.senses.driver, found.senses.driven],
        figures={name: figure_summary(name, own) for name, own in found.figures.items()},
        measured=found.whole.covered,
        encoders={name: _arcsec(own) for name, own in found.encoders.items()},
        encoders_twice={name: _arcsec(own) for name, own in found.encoders_twice.items()},
        closure={name: _arcsec(own) for name, own in found.closure.items()},
        winding=None if found.winding is None else _arcsec(found.winding, "arcsec/(N m)"),
        sides={side: _side(found, side, own) for side, own in found.alone.items()},
        residual=_residual(found),
        warnings=list(found.warnings),
    )


def figure_summary(name: str, figure: Figure) -> FigureSummary:
    """A figure in its unit."""
    unit, one = UNITS[name]
    return FigureSummary(value=figure.value / one, half_width=figure.half_width / one, unit=unit)


def alone_figures(own: OneSided) -> Mapping[str, Figure]:
    """Figures of one side, by the names of the joint fit's."""
    found = dict(own.figures)
    for name, end in (("jmin", own.least), ("jmax", own.largest)):
        found |= {f"{name} eccentric": end.backlash, f"{name} eccentric at": end.place}
    return found


def _arcsec(figure: Figure, unit: Unit = "arcsec") -> FigureSummary:
    return FigureSummary(value=figure.value / ARCSEC, half_width=figure.half_width / ARCSEC, unit=unit)


def _side(found: Identified, side: Side, own: OneSided) -> SideSummary:
    passes = [
        PassSummary(
            file=str(Path(read.path).name),
            repeat=read.repeat,
            rows=read.rows,
            turns=read.travel / TURN,
            shifted_by_turns=placed.turns,
            torque_least_n_m=None if read.torques is None else read.torques[0],
            torque_largest_n_m=None if read.torques is None else read.torques[1],
        )
        for read, placed in zip(found.read[side], found.passes[side], strict=True)
    ]
    alone = {name: figure_summary(name, figure) for name, figure in alone_figures(own).items()}
    return SideSummary(passes=passes, alone=alone, apart=own.apart, disagrees=own.disagrees)


def _residual(found: Identified) -> ResidualSummary:
    fit = found.fit
    orders = [
        OrderSummary(
            order=str(line.order),
            words=line.words,
            amplitude_arcsec={side: value / ARCSEC for side, value in line.amplitude.items()},
            noise_arcsec=max(line.noise.values()) / ARCSEC,
        )
        for line in found.spectrum.lines
    ]
    return ResidualSummary(
        sigma_arcsec=math.sqrt(fit.variance) / ARCSEC,
        noise_arcsec=found.teeth.noise / ARCSEC,
        low_orders=fit.low_orders,
        tooth_orders_fitted=list(fit.terms.teeth),
        drift_fitted=fit.terms.drift,
        orders=orders,
    )
