"""Scenes drafted from STEP files with their own tolerances: `scene_from`."""

from tol3d.drafting.checked import scene_from
from tol3d.drafting.draft import Draft, Seat

__all__ = ["Draft", "Seat", "scene_from"]
