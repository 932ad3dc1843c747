"""Foreign STEP files: their text (ISO 10303-21) read as records of parts, datums, tolerances and dimensions."""

from tol3d.step.datum import Datum
from tol3d.step.dimension import Dimension
from tol3d.step.frame import frame
from tol3d.step.outline import Remark, StepText, read_step_text
from tol3d.step.refused import StepError
from tol3d.step.structure import Leaf, Product, Structure
from tol3d.step.tolerance import Tolerance

__all__ = [
    "Datum",
    "Dimension",
    "Leaf",
    "Product",
    "Remark",
    "StepError",
    "StepText",
    "Structure",
    "Tolerance",
    "frame",
    "read_step_text",
]
