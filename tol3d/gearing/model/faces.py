"""Common faces of meshes, whose gears contributors shift along their axes by their means: mounting faces, shims.

Gears without such contributors have the middles of their faces in one plane: a mesh lays the shaft that it drives so.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from tol3d.gearing.effects import AxisOffset
from tol3d.gearing.model.model import Model
from tol3d.gearing.shafts import Mesh
from tol3d.gears.cylindrical_pair import CylindricalPair
from tol3d.scene import Scene
from tol3d.study.system.draw import Scalar

NARROWER: Final = 0.01  # of the common face; what a drawing shifts gears by is less, and no contact feels it


LEAST_WIDTH: Final = 1e-6  # mm; that of any face


@dataclass(frozen=True)
class CommonFace:
    """Common face of a mesh on parallel axes.

    Args:
        shift: of the driven gear against the driver along their axes [mm], by the means.
        width: on which both have teeth [mm]; negative where their faces lie apart.
        by: the contributors that shift them.
    """

    mesh: Mesh
    pair: CylindricalPair
    shift: float
    width: float
    by: tuple[str, ...]


def common_faces(model: Model) -> Iterator[CommonFace]:
    """Common faces of meshes whose gears are shifted."""
    for mesh in model.meshes:
        if not isinstance(pair := mesh.pair, CylindricalPair):
            continue
        shifts = {name: shift for name, shift in _shifts(model, mesh) if shift}
        if shifts:
            shift, driver, driven = sum(shifts.values()), pair.pinion.face_width / 2, pair.wheel.face_width / 2
            width = min(driver, shift + driven) - max(-driver, shift - driven)
            yield CommonFace(mesh, pair, shift, width, tuple(shifts))


def _shifts(model: Model, mesh: Mesh) -> Iterator[tuple[str, float]]:
    """Mean shifts of the driven gear, and of the driver with the other sign, by contributor [mm]."""
    for contributor in model.contributors:
        shift = 0.0
        for effect in contributor.effect.singles if isinstance(contributor.draw, Scalar) else ():
            if isinstance(effect, AxisOffset) and effect.acts_in(mesh):
                along = effect.direction[2] * effect.factor * contributor.distribution.mean
                shift += along if effect.part == mesh.driven else -along
        yield contributor.name, shift


def refuse_no_common_face(scene: Scene, model: Model) -> None:
    """Refuse gears on parallel axes whose faces do not overlap.

    Raises:
        SceneError: at the mesh.
    """
    for own in common_faces(model):
        if own.width < LEAST_WIDTH:
            mesh, most = own.mesh, (own.pair.pinion.face_width + own.pair.wheel.face_width) / 2
            words = (
                f"expected {mesh.driven!r} less than {most:g} mm off {mesh.driver!r} along the axis, half of both faces"
            )
            came = f"got no common face: {', '.join(map(repr, own.by))} put it {abs(own.shift):.4g} mm off"
            raise scene.refuse(("moves", mesh.name), f"{words}, {came}")


def no_common_face(mesh: Mesh, off: float) -> str:
    """Words on a driven gear so far off its driver along the axis [mm] that their faces do not overlap; else ""."""
    most = (mesh.pair.pinion.face_width + mesh.pair.wheel.face_width) / 2
    if abs(off) < most:
        return ""
    return f", and {mesh.driver!r} and {mesh.driven!r} have no common face, {abs(off):.4g} mm apart along the axis"


def narrower_faces(model: Model) -> Iterator[str]:
    """Warnings of faces that overlap less than the narrower one is wide."""
    for own in common_faces(model):
        if own.width < (1.0 - NARROWER) * own.pair.common_face:
            words = f"the common face is {own.width:.4g} mm of {own.pair.common_face:.4g} mm"
            by = f"{', '.join(map(repr, own.by))} put {own.mesh.driven!r} {abs(own.shift):.4g} mm off along the axis"
            yield f"{own.mesh.name}: {words}, for {by}; the analytic method takes all of it"
