"""How the meshes of a measure are read: what the scene says or what fits the pair; one tooth where it is in action."""

from collections.abc import Callable, Iterator
from typing import Literal

import numpy as np

from tol3d.gearing.grammar.measures import FlankMeasureSpec
from tol3d.gearing.model.measure import Kind, Measure, Reading
from tol3d.gearing.model.model import Model
from tol3d.gearing.model.shafts import Mesh
from tol3d.gears import one_tooth_acts, one_tooth_share
from tol3d.scene import Scene

Reader = Callable[[Mesh], Reading]
"""How each mesh on a path is read."""


def default_reading(mesh: Mesh) -> Reading:
    """All teeth, over the whole face of a cylinder, in the middle section of a cone."""
    return Reading("section", "section") if mesh.pair.arm_spread > 0.0 else Reading()


def reader_of(spec: FlankMeasureSpec) -> Reader:
    """What was said, or what fits the pair. A free turn goes from contact to contact, and both are read alike."""

    def read(mesh: Mesh) -> Reading:
        fitting = default_reading(mesh)
        read_at = spec.read_at or ("mean_section" if fitting.contact == "section" else "face")
        contact: Literal["face", "section"] = "section" if read_at == "mean_section" else "face"
        gap = "section" if read_at == "face_contact" and spec.kind == "normal_backlash" else contact
        return Reading(contact, gap, spec.tooth)

    return read


def reader_like(kind: Kind | None) -> Reader:
    """As another measure reads the same meshes; by default where it reads others, or there is none."""
    known = {} if kind is None else {backlash.mesh: backlash.reading for _, backlash in kind.backlashes}
    return lambda mesh: known.get(mesh.name) or default_reading(mesh)


def refuse_idle_teeth(scene: Scene, place: tuple[str, ...], measure: Measure, model: Model) -> None:
    """Refuse to read one tooth at positions at which its flanks are not both in action.

    Args:
        scene, place: what is refused there.
        measure: with its readings and positions.
        model: its meshes.

    Raises:
        SceneError: with the number of positions or the share of them all.
    """
    for said in _idle(measure, model):
        raise scene.refuse(
            place,
            f"expected all, got {said}; elsewhere a neighbour carries, and a tip edge is all that could be read of it",
        )


def _idle(measure: Measure, model: Model) -> Iterator[str]:
    """The meshes of which a measure reads a tooth that is out of action somewhere, and how often."""
    for _, backlash in measure.kind.backlashes:
        mesh, owner = model.mesh(backlash.mesh), backlash.reading.teeth
        if owner == "all":
            continue
        angles = model.driver_angles(measure, mesh.name)
        name = mesh.driver if owner == "driver" else mesh.driven
        where = f"next to the line of centres of {mesh.name!r}"
        tooth = f"{owner}: both flanks of the tooth of {name!r} {where} are in action at"
        if angles is None:
            share = one_tooth_share(mesh.pair, owner)
            if share < 1.0:
                yield f"{tooth} {100 * share:.3g} % of the positions only"
        else:
            acts = one_tooth_acts(mesh.pair, np.array(angles), owner)
            if not acts.all():
                yield f"{tooth} {np.count_nonzero(acts)} of {len(acts)} positions only"
