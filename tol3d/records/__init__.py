"""Measured data and its identification: gears on a transmission error rig, and the rig itself, synthetic.

    files        rows, block by block       csv_file.py                 blocks_of
    reading      rows -> position bins      reading.py                  read_side
    alignment    the long period            alignment.py                aligned
    fit          both sides together        fit.py                      fitted
    prediction   the whole long period      prediction.py               predicted
    findings     all of it                  identify.py                 identify         (findings.py: Identified)
    cautions     possible errors of them    cautions.py                 cautions

`pair.py` is the geometry, without the assumption of small eccentricities; `rig.py` makes measured files of it,
`planning.py` predicts the accuracy of a rig of that kind.
"""

from tol3d.records.findings import Identified, Settings
from tol3d.records.identify import identify
from tol3d.records.pair import RigPair, Specimen
from tol3d.records.planning import RigPlan, plan_rig
from tol3d.records.rig import Rig, measured

__all__ = ["Identified", "Rig", "RigPair", "RigPlan", "Settings", "Specimen", "identify", "measured", "plan_rig"]
