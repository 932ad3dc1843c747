"""Foreign STEP files: their text (ISO 10303-21) read as records of parts, datums, tolerances and dimensions."""

from typing import TYPE_CHECKING

from tol3d.import_path import lazy_names
from tol3d.step.datum import Datum
from tol3d.step.dimension import Dimension
from tol3d.step.frame import frame
from tol3d.step.outline import Remark, StepText, read_step_text
from tol3d.step.refused import StepError
from tol3d.step.structure import Leaf, Product, Structure
from tol3d.step.tolerance import Tolerance

if TYPE_CHECKING:
    from tol3d.step.faces import extent
    from tol3d.step.found import (
        FoundFeature,
        Triple,
        by_place,
    )
    from tol3d.step.meaning import (
        LOCATIONS,
        MATERIAL,
        ORIENTATIONS,
        Meaning,
        Meanings,
        surfaces_of,
    )
    from tol3d.step.reading import (
        StepFile,
        StepPart,
        Use,
        read_step,
    )
    from tol3d.step.refused import (
        LONGEST_SHOWN,
        shown,
    )
    from tol3d.step.selecting import (
        Selector,
        line_of,
        selected,
    )
    from tol3d.step.shape import shape_of

_HOMES = {
    "LOCATIONS": "tol3d.step.meaning",
    "LONGEST_SHOWN": "tol3d.step.refused",
    "MATERIAL": "tol3d.step.meaning",
    "ORIENTATIONS": "tol3d.step.meaning",
    "FoundFeature": "tol3d.step.found",
    "Meaning": "tol3d.step.meaning",
    "Meanings": "tol3d.step.meaning",
    "Selector": "tol3d.step.selecting",
    "StepFile": "tol3d.step.reading",
    "StepPart": "tol3d.step.reading",
    "Triple": "tol3d.step.found",
    "Use": "tol3d.step.reading",
    "by_place": "tol3d.step.found",
    "extent": "tol3d.step.faces",
    "line_of": "tol3d.step.selecting",
    "read_step": "tol3d.step.reading",
    "selected": "tol3d.step.selecting",
    "shape_of": "tol3d.step.shape",
    "shown": "tol3d.step.refused",
    "surfaces_of": "tol3d.step.meaning",
}

__all__ = [
    "LOCATIONS",
    "LONGEST_SHOWN",
    "MATERIAL",
    "ORIENTATIONS",
    "Datum",
    "Dimension",
    "FoundFeature",
    "Leaf",
    "Meaning",
    "Meanings",
    "Product",
    "Remark",
    "Selector",
    "StepError",
    "StepFile",
    "StepPart",
    "StepText",
    "Structure",
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
