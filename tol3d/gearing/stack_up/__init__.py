"""The reference method: nominal values and stack-ups with their sources. It never sees a mesh, a pose or an engine."""

from tol3d.gearing.stack_up.closed_form import closed_form, reference_form
from tol3d.gearing.stack_up.measures import (
    analytic_backlash,
    analytic_transmission_error,
    first_order,
    per_normal_backlash,
    stack_of,
)
from tol3d.gearing.stack_up.stack import Stack
from tol3d.gearing.stack_up.term import Term

__all__ = [
    "Stack",
    "Term",
    "analytic_backlash",
    "analytic_transmission_error",
    "closed_form",
    "first_order",
    "per_normal_backlash",
    "reference_form",
    "stack_of",
]
