"""Shafts that cross their radial clearances where the load changes sides: readings of it, and loads that disagree."""

from dataclasses import replace

from tol3d.gearing.effects import Reversing
from tol3d.gearing.model.measure import Reading
from tol3d.gearing.model.model import Model
from tol3d.gearing.shafts import Mesh
from tol3d.scene import Scene


def of_reversals(model: Model, mesh: Mesh, reading: Reading) -> Reading:
    """A reading of lost motion: where shafts cross their clearances, each flank under its own load."""
    return replace(reading, reversing=True) if model.reverses(mesh) else reading


def refuse_opposed_loads(scene: Scene, model: Model) -> None:
    """Refuse working flanks that are not loaded at once on a shaft that crosses its clearance.

    Raises:
        SceneError: at the tolerance.
    """
    for contributor in model.contributors:
        if not isinstance(contributor.effect, Reversing):
            continue
        first, *others = (mesh for mesh in model.meshes if contributor.effect.acts_in(mesh))
        for mesh in others:
            if _load(model, mesh) != _load(model, first):
                words = (
                    f"expected working flanks that are loaded at once, got those of {first.name!r} and {mesh.name!r}"
                )
                advice = "let the train's load choose (working_flank: either), or change one"
                raise scene.refuse(("tolerances", contributor.name, "direction"), f"{words}, which are not; {advice}")


def _load(model: Model, mesh: Mesh) -> bool:
    """Sense of the torque at the first shaft of its tree that loads a mesh's working flanks."""
    shaft, carried = model.layout.carrying[mesh.driven]
    return mesh.driven_flank * carried.sense * model.layout.shaft_turn[shaft].rate > 0
