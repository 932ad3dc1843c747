"""Foreign STEP files: their text (ISO 10303-21) read as records of parts, datums, tolerances and dimensions."""

from typing import TYPE_CHECKING

from tol3d.cad.step.datum import Datum
from tol3d.cad.step.dimension import Dimension
from tol3d.cad.step.frame import frame
from tol3d.cad.step.outline import Remark, StepText, read_step_text
from tol3d.cad.step.refused import StepError
from tol3d.cad.step.structure import Leaf, Product, Structure
from tol3d.cad.step.tolerance import Tolerance
from tol3d.import_path import lazy_names

if TYPE_CHECKING:
    from tol3d.cad.step.faces import extent
    from tol3d.cad.step.found_features import FoundFeature, Triple, by_place
    from tol3d.cad.step.machined import HolePattern, Machined, Slot, Stepped, Tab
    from tol3d.cad.step.meaning import LOCATIONS, MATERIAL, ORIENTATIONS, Meaning, Meanings, surfaces_of
    from tol3d.cad.step.reading import StepFile, StepPart, Use, read_step
    from tol3d.cad.step.refused import LONGEST_SHOWN, shown
    from tol3d.cad.step.selectors import Selector, line_of, selected
    from tol3d.cad.step.shape import shape_of

_HOMES = {
    "LOCATIONS": "tol3d.cad.step.meaning",
    "LONGEST_SHOWN": "tol3d.cad.step.refused",
    "MATERIAL": "tol3d.cad.step.meaning",
    "ORIENTATIONS": "tol3d.cad.step.meaning",
    "FoundFeature": "tol3d.cad.step.found_features",
    "HolePattern": "tol3d.cad.step.machined",
    "Machined": "tol3d.cad.step.machined",
    "Meaning": "tol3d.cad.step.meaning",
    "Meanings": "tol3d.cad.step.meaning",
    "Selector": "tol3d.cad.step.selectors",
    "Slot": "tol3d.cad.step.machined",
    "StepFile": "tol3d.cad.step.reading",
    "StepPart": "tol3d.cad.step.reading",
    "Stepped": "tol3d.cad.step.machined",
    "Tab": "tol3d.cad.step.machined",
    "Triple": "tol3d.cad.step.found_features",
    "Use": "tol3d.cad.step.reading",
    "by_place": "tol3d.cad.step.found_features",
    "extent": "tol3d.cad.step.faces",
    "line_of": "tol3d.cad.step.selectors",
    "read_step": "tol3d.cad.step.reading",
    "selected": "tol3d.cad.step.selectors",
    "shape_of": "tol3d.cad.step.shape",
    "shown": "tol3d.cad.step.refused",
    "surfaces_of": "tol3d.cad.step.meaning",
}

__all__ = [
    "LOCATIONS",
    "LONGEST_SHOWN",
    "MATERIAL",
    "ORIENTATIONS",
    "Datum",
    "Dimension",
    "FoundFeature",
    "HolePattern",
    "Leaf",
    "Machined",
    "Meaning",
    "Meanings",
    "Product",
    "Remark",
    "Selector",
    "Slot",
    "StepError",
    "StepFile",
    "StepPart",
    "StepText",
    "Stepped",
    "Structure",
    "Tab",
    "Tolerance",
    "Triple",
    "Use",
    "by_place",
    "extent",
    "frame",
    "line_of",
    "read_step",
    "read_step_text",
    "selected",
    "shape_of",
    "shown",
    "surfaces_of",
]

__getattr__, __dir__ = lazy_names(__name__, _HOMES)
