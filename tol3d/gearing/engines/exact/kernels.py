"""The kernels: one of each sort for every kind of pair, compiled for the arrays of a Build and no others."""

from tol3d.gearing.engines.exact.bevel import BevelTooth
from tol3d.gearing.engines.exact.numbers import PairNumbers, Pose
from tol3d.gearing.engines.exact.rests import rest_rows
from tol3d.gearing.engines.exact.rows import gap_rows, read_rows
from tol3d.gearing.engines.exact.spur import SpurTooth
from tol3d.numerics.compiled import Kernel

BUILD = "float64[:, :, :, ::1], float64[:, :, ::1], float64[:, ::1], float64[:, ::1], float64[:, ::1]"
READ = f"int64[::1], {BUILD}, float64[::1], float64[:, ::1], int64[::1], int8[::1]"
REST = f"int64[::1], {BUILD}, float64[::1], float64[:, :, ::1], float64[:, :, ::1], int64[:, ::1], int8[:, ::1]"
GAPS = (
    f"int64[::1], {BUILD}, float64[::1], float64[::1], int64[:, ::1], boolean[:, ::1], "
    "float64[:, ::1], float64[:, :, :, ::1], boolean[:, ::1]"
)

SPUR = (SpurTooth, SpurTooth, PairNumbers, Pose)
BEVEL = (BevelTooth, BevelTooth, PairNumbers, Pose)

spur_read, spur_gaps = Kernel(read_rows, SPUR, READ), Kernel(gap_rows, SPUR, GAPS)
bevel_read, bevel_gaps = Kernel(read_rows, BEVEL, READ), Kernel(gap_rows, BEVEL, GAPS)
spur_rests, bevel_rests = Kernel(rest_rows, SPUR, REST), Kernel(rest_rows, BEVEL, REST)
