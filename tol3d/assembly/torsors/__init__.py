"""The analytic method: small displacements, propagated by linear algebra from the nominal geometry.

Trials are linear in their deviations, except for a few terms: the corner by which a plane touches, the largest of
several amounts that a measure takes, a pose of least largest residual. Those are evaluated trial by trial.
"""

from tol3d.assembly.torsors.first_order import Bend, FirstOrder, Slopes, first_order
from tol3d.assembly.torsors.method import slopes, values

__all__ = ["Bend", "FirstOrder", "Slopes", "first_order", "slopes", "values"]
