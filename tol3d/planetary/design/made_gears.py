"""A designed set as gears of the house, judged by their own rules of what can be made and what interferes."""

from tol3d.errors import GeometryError
from tol3d.gears.internal_gear import InternalGear
from tol3d.gears.internal_pair import InternalPair
from tol3d.gears.spur_gear import SpurGear
from tol3d.gears.spur_pair import SpurPair
from tol3d.planetary.design.shifted_set import ShiftedSet
from tol3d.planetary.design.working_mesh import WorkingMesh

FACE_WIDTH = 10.0  # modules; it decides nothing here


def made_pair(own: WorkingMesh) -> SpurPair | InternalPair:
    """The gears of a mesh at its centre distance: the sun drives its planet, a planet its ring.

    Raises:
        GeometryError: a gear cannot be made.
    """
    rack, mesh = own.rack, own.mesh
    common = (rack.module, rack.pressure_angle, FACE_WIDTH * rack.module)
    factors = {"addendum": rack.addendum, "dedendum": rack.dedendum}
    planet = SpurGear(mesh.planet_teeth, *common, profile_shift=own.planet_shift, **factors)
    if mesh.internal:
        ring = InternalGear(mesh.teeth, *common, profile_shift=own.central_shift, **factors)
        return InternalPair(planet, ring, own.centre_distance)
    sun = SpurGear(mesh.teeth, *common, profile_shift=own.central_shift, **factors)
    return SpurPair(sun, planet, own.centre_distance)


def refuse_interference(own: ShiftedSet) -> None:
    """Raise unless all its gears can be made and run together.

    Raises:
        GeometryError: with the mesh, the radii and what to change.
    """
    for mesh in own.meshes:
        try:
            made_pair(mesh).refuse_interference()
        except GeometryError as error:
            raise GeometryError(f"mesh of {mesh.mesh.central}: {error}") from error
