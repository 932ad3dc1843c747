"""Tolerance zones as sets of small displacements, and draws from them by named laws.

`catalogue` has the zones; `uniform_in`, `normal_in`, `ring_in` and `process_in` make a draw of one; `Bonus` widens a
zone by the size of its feature, `Widened` draws from what it leaves. An `Envelope` bounds a form by the same size.
"""

from tol3d.assembly.zones.form_draw import EnvelopedForm, FittedForm
from tol3d.assembly.zones.widened import Bonus, Envelope, JudgedProcess, SizedBy, Widened
from tol3d.assembly.zones.zone import Zone
from tol3d.assembly.zones.zone_draw import (
    Confined,
    Process,
    ZoneDraw,
    laws_told,
    normal_in,
    process_in,
    ring_in,
    uniform_in,
)

__all__ = [
    "Bonus",
    "Confined",
    "Envelope",
    "EnvelopedForm",
    "FittedForm",
    "JudgedProcess",
    "Process",
    "SizedBy",
    "Widened",
    "Zone",
    "ZoneDraw",
    "laws_told",
    "normal_in",
    "process_in",
    "ring_in",
    "uniform_in",
]
