"""The folder that `identify` writes: findings, curve, tables, pictures and the identified pair as a scene."""

from pathlib import Path
from typing import TYPE_CHECKING

from tol3d.records.curve import curve_of
from tol3d.records.folder import write_texts
from tol3d.records.from_scene import scene_text
from tol3d.records.identified_picture import draw_backlash, draw_residual
from tol3d.records.identify import Identified
from tol3d.records.summary import summary_of
from tol3d.report.page import Page

if TYPE_CHECKING:
    from tol3d.gearing.model.mesh import Mesh


def write_identified(found: Identified, report: Page, mesh: "Mesh", scene: str, folder: Path) -> tuple[Path, ...]:
    """Write what was identified; files of an earlier time are replaced.

    Args:
        found: what was identified.
        report: its tables.
        mesh: of which gears.
        scene: the scene's name.
        folder: where to; made if it is not there.

    Raises:
        InputError: it cannot be written.
    """
    curve = curve_of(found)
    texts = {
        "identified.json": summary_of(found, scene, mesh.name).model_dump_json(indent=2) + "\n",
        "identified.csv": report.csv(),
        "backlash.csv": curve.csv(),
        "identified.yaml": scene_text(found.specimen, mesh, f"{scene}, as identified"),
    }
    written = write_texts(texts, folder)
    pictures = folder / "backlash.png", folder / "residual.png"
    draw_backlash(found, curve, pictures[0])
    draw_residual(found, pictures[1])
    return *written, *pictures
