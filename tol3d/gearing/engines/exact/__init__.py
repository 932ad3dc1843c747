"""The exact engine: compiled contact of mathematical flanks.

`spur`, `internal`, `bevel` and `deviated` give the foot of a point on the mate's flank; `nearest` finds the nearest
points of two flanks by it, `flank_contact` brings a pair to contact and reads it, `rows` and `rests` go over builds and
positions, `kernels` compiles all this for each kind of pair, and `engine` offers it to studies.
"""

from tol3d.gearing.engines.exact.engine import ExactEngine

__all__ = ["ExactEngine"]
