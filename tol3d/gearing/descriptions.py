"""What a measure of gears is, by keys of summary.json."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from tol3d.gearing.model import Backlash, Measure, Model
from tol3d.gearing.stack_up import per_normal_backlash


def description(model: Model, measure: Measure) -> Mapping[str, Any]:
    """Kind, of what, how it is read; of a normal backlash also the turn that it leaves free per um."""
    kind = measure.kind
    if isinstance(kind, Backlash):
        own = {"kind": kind.quantity, "of": kind.mesh, "gear": kind.gear, "reading": vars(kind.reading)}
        return own | _free_turn(model, kind)
    return {
        "kind": kind.quantity,
        "of": kind.train,
        "gear": None,
        "reading": None,
        "readings": {backlash.mesh: vars(backlash.reading) for _, backlash in kind.backlashes},
        "shaft": kind.shaft,
        "held": kind.held,
        "arm": kind.tip.arm if kind.tip else None,
        "point": kind.tip.point if kind.tip else None,
        "lever_mm": kind.tip.lever if kind.tip else None,
        "load_changes_deg": np.degrees(kind.changes).tolist(),
    }


def _free_turn(model: Model, kind: Backlash) -> dict[str, Any]:
    if kind.quantity != "normal_backlash":
        return {}
    driven = model.mesh(kind.mesh).driven
    turn = per_normal_backlash(model, Backlash("angular_backlash", kind.mesh, driven))
    return {"lost_motion": {"of": driven, "arcmin_per_um": turn * np.degrees(60) / 1000}}
