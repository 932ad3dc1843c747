"""Scenes drafted from STEP files with their own tolerances: `scene_from`."""

from typing import TYPE_CHECKING

from tol3d.import_path import lazy_names

if TYPE_CHECKING:
    from tol3d.apps.drafting.checked import scene_from
    from tol3d.apps.drafting.draft import Draft, Seat

_HOMES = {
    "Draft": "tol3d.apps.drafting.draft",
    "Seat": "tol3d.apps.drafting.draft",
    "scene_from": "tol3d.apps.drafting.checked",
}

__all__ = ["Draft", "Seat", "scene_from"]

__getattr__, __dir__ = lazy_names(__name__, _HOMES)
