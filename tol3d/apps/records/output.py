"""The folder that `identify` writes: findings, curve, tables, pictures and the identified pair as a scene."""

import os
from pathlib import Path
from typing import Final

from tol3d.apps.records.findings import Identified
from tol3d.apps.records.from_scene import scene_text
from tol3d.apps.records.identified_picture import curve_of, draw_backlash, draw_residual
from tol3d.apps.records.rig import begins_with
from tol3d.apps.records.scene_mesh import SceneMesh
from tol3d.apps.records.summary import IdentifiedSummary, summary_of
from tol3d.errors import InputError
from tol3d.report.page import Page
from tol3d.study.runs import write_texts

NAMES: Final = ("identified.json", "identified.csv", "backlash.csv", "identified.yaml", "backlash.png", "residual.png")


def refuse_others(folder: Path) -> None:
    """Refuse a folder that has files of these names without findings of ours: they belong to the user.

    Raises:
        InputError: it names them.
    """
    there = [name for name in NAMES if os.path.lexists(folder / name)]
    if not there or _is_ours(folder / NAMES[0]):
        return
    raise InputError(
        f"{folder}: holds {', '.join(there)}, not written by `tol3d identify`, which replaces files of its own only; "
        "choose another folder: --out"
    )


def _is_ours(path: Path) -> bool:
    return begins_with(path, f'{{\n  "format": "{IdentifiedSummary.model_fields["format"].default}"')


def write_identified(found: Identified, report: Page, own: SceneMesh, folder: Path) -> tuple[Path, ...]:
    """Write the identification; earlier files are replaced.

    Args:
        found: identification to write.
        report: its tables.
        own: the gears.
        folder: where to; made if it is not there.

    Raises:
        InputError: it cannot be written.
    """
    curve = curve_of(found)
    texts = {
        "identified.json": summary_of(found, own).model_dump_json(indent=2) + "\n",
        "identified.csv": report.csv(),
        "backlash.csv": curve.csv(),
        "identified.yaml": scene_text(found.specimen, own.mesh, f"{own.scene}, as identified"),
    }
    written = write_texts(texts, folder)
    pictures = folder / "backlash.png", folder / "residual.png"
    draw_backlash(found, curve, pictures[0])
    draw_residual(found, pictures[1])
    return *written, *pictures
