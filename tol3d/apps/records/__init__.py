"""Measured data and its identification: gears on a transmission error rig, and the rig itself, synthetic.

    files        rows, block by block       csv_file.py                 blocks_of
    reading      rows -> position bins      reading.py                  read_side
    alignment    the long period            alignment.py                aligned
    fit          both sides together        fit.py                      fitted
    prediction   the whole long period      prediction.py               predicted
    findings     all of it                  identification.py           identify         (findings.py: Identified)
    cautions     possible errors of them    cautions.py                 cautions

`pair.py` is the geometry, without the assumption of small eccentricities; `rig.py` makes measured files of it,
`planning.py` predicts the accuracy of a rig of that kind.
"""

from typing import TYPE_CHECKING

from tol3d.import_path import lazy_names

if TYPE_CHECKING:
    from tol3d.apps.records.findings import Identified, Settings
    from tol3d.apps.records.identification import identify
    from tol3d.apps.records.pair import RigPair, Specimen
    from tol3d.apps.records.planning import RigPlan, plan_rig
    from tol3d.apps.records.rig import Rig, measured

_HOMES = {
    "Identified": "tol3d.apps.records.findings",
    "Rig": "tol3d.apps.records.rig",
    "RigPair": "tol3d.apps.records.pair",
    "RigPlan": "tol3d.apps.records.planning",
    "Settings": "tol3d.apps.records.findings",
    "Specimen": "tol3d.apps.records.pair",
    "identify": "tol3d.apps.records.identification",
    "measured": "tol3d.apps.records.rig",
    "plan_rig": "tol3d.apps.records.planning",
}

__all__ = ["Identified", "Rig", "RigPair", "RigPlan", "Settings", "Specimen", "identify", "measured", "plan_rig"]

__getattr__, __dir__ = lazy_names(__name__, _HOMES)
