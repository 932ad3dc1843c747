"""What a measure of gears is, by keys of summary.json."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from tol3d.gearing.model import Backlash, Measure, Model, TransmissionError
from tol3d.gearing.model.measure import Reading as ModelReading
from tol3d.gearing.stack_up import per_normal_backlash
from tol3d.gearing.summary.measure_words import Reading
from tol3d.gearing.summary.types import BacklashWords, FreeTurn, TrainMeasureWords, TransmissionErrorWords
from tol3d.runs.summary.values import made


def description(model: Model, measure: Measure) -> Mapping[str, Any]:
    """Kind, of what, how it is read; of a normal backlash also the turn that it leaves free per um."""
    kind = measure.kind
    if isinstance(kind, Backlash):
        if kind.quantity == "rest_angle":
            raise ValueError(f"{measure.name}: an angle at rest is no measure, others are made of it")
        own = made(
            BacklashWords,
            kind=kind.quantity,
            of=kind.mesh,
            gear=kind.gear,
            reading=_reading(kind.reading),
            lost_motion=_free_turn(model, kind),
        )
        return dict(own.items())
    if isinstance(kind, TransmissionError):
        return _transmission_error(kind)
    words = made(
        TrainMeasureWords,
        kind=kind.quantity,
        of=kind.train,
        gear=None,
        reading=None,
        readings={backlash.mesh: _reading(backlash.reading) for _, backlash in kind.backlashes},
        shaft=kind.shaft,
        held=kind.held,
        arm=kind.tip.arm if kind.tip else None,
        point=kind.tip.point if kind.tip else None,
        lever_mm=kind.tip.lever if kind.tip else None,
        load_changes_deg=np.degrees(kind.changes).tolist(),
    )
    return dict(words.items())


def _transmission_error(kind: TransmissionError) -> Mapping[str, Any]:
    own = made(
        TransmissionErrorWords,
        kind="transmission_error",
        of=kind.of,
        gear=kind.gear,
        flank=kind.flank,
        reading=None,
        readings={backlash.mesh: _reading(backlash.reading) for _, backlash in kind.backlashes},
    )
    return dict(own.items())


def _reading(reading: ModelReading) -> Reading:
    return made(Reading, contact=reading.contact, gap=reading.gap, teeth=reading.teeth)


def _free_turn(model: Model, kind: Backlash) -> FreeTurn | None:
    if kind.quantity != "normal_backlash":
        return None
    driven = model.mesh(kind.mesh).driven
    turn = per_normal_backlash(model, Backlash("angular_backlash", kind.mesh, driven))
    return made(FreeTurn, of=driven, arcmin_per_um=turn * np.degrees(60) / 1000)
