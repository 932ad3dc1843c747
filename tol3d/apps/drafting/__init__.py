"""Scenes drafted from STEP files with their own tolerances: `scene_from`; from REXS files: see `rexs`."""

from typing import TYPE_CHECKING

from tol3d.import_path import lazy_names

if TYPE_CHECKING:
    from tol3d.apps.drafting.draft import Draft, Seat, scene_from

_HOMES = {
    "Draft": "tol3d.apps.drafting.draft",
    "Seat": "tol3d.apps.drafting.draft",
    "scene_from": "tol3d.apps.drafting.draft",
}

__all__ = ["Draft", "Seat", "scene_from"]

__getattr__, __dir__ = lazy_names(__name__, _HOMES)
