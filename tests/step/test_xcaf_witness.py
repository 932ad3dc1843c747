"""Open CASCADE's own reading of tolerances as a witness where its values are right, and its known errors pinned."""

from functools import cache
from pathlib import Path
from typing import Any

import pytest
from nist import FILES, step_bytes, step_text

pytestmark = pytest.mark.slow

SEEN = {"CTC-01": 6, "FTC-07": 25, "FTC-10": 35, "STC-06": 25, "STC-07": 10, "CTC-05": 10}
"""Tolerances that XCAF has: it drops those on curves, on derived centres, on nothing, and those per unit."""
RIGHT = ("FTC-07", "FTC-10", "STC-06", "CTC-05")
"""Models whose magnitudes XCAF reads; 0 on the others, whose measures are complex instances."""


@cache
def seen(model: str, folder: Path) -> list[tuple[float, tuple[str, ...], int]]:
    """Magnitude [mm], letters of datums and number of shapes of each tolerance that XCAF has."""
    caf = pytest.importorskip("OCP.STEPCAFControl")
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDF import TDF_LabelSequence
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_Datum, XCAFDoc_DimTolTool, XCAFDoc_DocumentTool, XCAFDoc_GeomTolerance

    path = folder / "model.stp"
    path.write_bytes(step_bytes(model))
    document = TDocStd_Document(TCollection_ExtendedString("doc"))
    reader = caf.STEPCAFControl_Reader()
    reader.SetGDTMode(True)
    reader.ReadFile(str(path))
    reader.Transfer(document)
    tool = XCAFDoc_DocumentTool.DimTolTool_s(document.Main())
    labels = TDF_LabelSequence()
    tool.GetGeomToleranceLabels(labels)
    found = []
    for index in range(1, labels.Length() + 1):
        label: Any = labels.Value(index)
        datums, first, second = TDF_LabelSequence(), TDF_LabelSequence(), TDF_LabelSequence()
        XCAFDoc_DimTolTool.GetDatumWithObjectOfTolerLabels_s(label, datums)
        letters = sorted(
            {
                XCAFDoc_Datum.Set_s(datums.Value(each)).GetObject().GetName().ToCString()
                for each in range(1, datums.Length() + 1)
            }
        )
        XCAFDoc_DimTolTool.GetRefShapeLabel_s(label, first, second)
        found.append((XCAFDoc_GeomTolerance.Set_s(label).GetObject().GetValue(), tuple(letters), first.Length()))
    return found


@pytest.mark.parametrize("model", FILES)
def test_xcaf_has_no_tolerance_that_is_not_read(model: str, tmp_path_factory: pytest.TempPathFactory) -> None:
    theirs = seen(model, tmp_path_factory.mktemp(model))
    assert len(theirs) == SEEN[model]
    ours = [
        (
            tolerance.magnitude.value if tolerance.magnitude and model in RIGHT else 0.0,
            tuple(sorted(letter.letter for each in tolerance.datums for letter in each.references)),
            len(tolerance.feature.faces) + len(tolerance.feature.curves),
        )
        for tolerance in step_text(model).tolerances
    ]
    for magnitude, letters, shapes in theirs:  # 0.0 where theirs is lost
        alike = [each for each in ours if each[1:] == (letters, shapes) and abs(each[0] - magnitude) < 1e-9]
        assert alike, (magnitude, letters, shapes)
        ours.remove(alike[0])
