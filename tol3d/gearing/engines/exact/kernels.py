"""The kernels: one of each sort for every kind of pair, compiled for the arrays of a Build and no others."""

from tol3d.gearing.engines.exact.bevel import BevelTooth
from tol3d.gearing.engines.exact.deviated import DeviatedTooth
from tol3d.gearing.engines.exact.deviated_rows import gap_deviated_rows, read_deviated_rows
from tol3d.gearing.engines.exact.internal import InternalTooth
from tol3d.gearing.engines.exact.numbers import PairNumbers, Pose
from tol3d.gearing.engines.exact.rests import rest_rows
from tol3d.gearing.engines.exact.rows import gap_rows, read_rows
from tol3d.gearing.engines.exact.spur import SpurTooth
from tol3d.gearing.engines.exact.tooth_rests import rest_deviated_rows
from tol3d.numerics.compiled import Kernel

BUILD = "float64[:, :, :, ::1], float64[:, :, ::1], float64[:, ::1], float64[:, ::1], float64[:, ::1]"
RESTING = "float64[::1], float64[:, :, ::1], float64[:, :, ::1], int64[:, ::1], int8[:, ::1]"
READING = "float64[::1], float64[:, ::1], int64[::1], int8[::1]"
GAP = (
    "float64[::1], float64[::1], int64[:, ::1], boolean[:, ::1], "
    "float64[:, ::1], float64[:, :, :, ::1], boolean[:, ::1]"
)
READ, GAPS, REST = (f"int64[::1], {BUILD}, {own}" for own in (READING, GAP, RESTING))
FLANKS = "float64[:, ::1], int64[::1], int64[::1]"
READ_DEVIATED, GAPS_DEVIATED, REST_DEVIATED = (
    f"int64[::1], {BUILD}, {FLANKS}, {own}" for own in (READING, GAP, RESTING)
)

SPUR = (SpurTooth, SpurTooth, PairNumbers, Pose)
DEVIATED = (DeviatedTooth, DeviatedTooth, PairNumbers, Pose)
INTERNAL = (InternalTooth, InternalTooth, PairNumbers, Pose)
BEVEL = (BevelTooth, BevelTooth, PairNumbers, Pose)

spur_read, spur_gaps = Kernel(read_rows, SPUR, READ), Kernel(gap_rows, SPUR, GAPS)
bevel_read, bevel_gaps = Kernel(read_rows, BEVEL, READ), Kernel(gap_rows, BEVEL, GAPS)
spur_rests, bevel_rests = Kernel(rest_rows, SPUR, REST), Kernel(rest_rows, BEVEL, REST)
internal_read, internal_gaps = Kernel(read_rows, INTERNAL, READ), Kernel(gap_rows, INTERNAL, GAPS)
internal_rests = Kernel(rest_rows, INTERNAL, REST)
deviated_read = Kernel(read_deviated_rows, DEVIATED, READ_DEVIATED)
deviated_gaps = Kernel(gap_deviated_rows, DEVIATED, GAPS_DEVIATED)
deviated_rests = Kernel(rest_deviated_rows, DEVIATED, REST_DEVIATED)
