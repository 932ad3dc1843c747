"""Scene to model: text becomes meaning, units become mm and rad, gears become geometry or are refused."""

from collections.abc import Iterator
from typing import Literal

from tol3d.gears import LEFT, RIGHT
from tol3d.model.effects import Tolerances
from tol3d.model.measure import Backlash, Measure, Positions, Reading
from tol3d.model.model import GearPart, Housing, Mesh, Model, Study, Until
from tol3d.model.pairs import internal, pair_of, undercut_warning
from tol3d.scene import Scene
from tol3d.scene.direction import At
from tol3d.scene.measures import MeasureSpec, MeasureUnion
from tol3d.scene.moves import GearMeshSpec
from tol3d.scene.parts import GearSpec, HousingSpec
from tol3d.scene.schema import Study as StudySpec
from tol3d.units import Quantity


def model_from_scene(scene: Scene) -> Model:
    """What a scene means.

    Raises:
        SceneError: gears that cannot be made or run together, with their numbers and place.
    """
    _refuse_shared_and_idle_gears(scene)
    meshes = tuple(_mesh(scene, name, move) for name, move in scene.moves.items())
    by_name = {mesh.name: mesh for mesh in meshes}
    tolerances = Tolerances(scene, by_name)
    return Model(
        name=scene.scene,
        gears=tuple(_gears(scene, by_name)),
        housings=tuple(
            Housing(name, internal(part.expansion))
            for name, part in scene.parts.items()
            if isinstance(part, HousingSpec)
        ),
        contributors=tuple(tolerances.contributor(name, spec) for name, spec in scene.tolerances.items()),
        meshes=meshes,
        measures=tuple(_measure(name, spec, by_name[spec.of]) for name, spec in scene.measures.items()),
        study=_study(scene.study),
        published=_published(scene),
        gear_warnings=tuple(_warnings(meshes)),
    )


def _study(spec: StudySpec) -> Study:
    """The study; an automatic one is its trials at most, and when it may stop before."""
    return Study(
        trials=spec.at_most if spec.trials == "auto" else spec.trials,
        seed=spec.seed,
        sampler=spec.sampler,
        replicates=spec.parts,
        until=tuple(
            Until(name, _internal(errors.mean), _internal(errors.sigma)) for name, errors in spec.until.items()
        ),
        engine=spec.engine,
        witness=spec.witness,
        profile_steps=spec.profile_steps,
    )


def _internal(quantity: Quantity | None) -> float | None:
    return None if quantity is None else quantity.internal


def _refuse_shared_and_idle_gears(scene: Scene) -> None:
    for name, part in scene.parts.items():
        meshes = scene.meshes_of(name)
        if len(meshes) > 1:
            raise scene.refuse(
                ("moves", meshes[1]),
                f"{name!r} is in {' and '.join(map(repr, meshes))}; a gear can be in one mesh only so far",
            )
        if isinstance(part, GearSpec) and not meshes:
            raise scene.refuse(("parts", name), f"{name!r} takes part in no move; put it into a mesh or take it out")


def _mesh(scene: Scene, name: str, move: GearMeshSpec) -> Mesh:
    return Mesh(
        name=name,
        driver=move.driver,
        driven=move.driven,
        pair=pair_of(move, name, scene),
        working_flank=RIGHT if move.working_flank == "right" else LEFT,
        housing=getattr(move, "housing", None),
    )


def _gears(scene: Scene, meshes: dict[str, Mesh]) -> Iterator[GearPart]:
    for name, part in scene.parts.items():
        if isinstance(part, GearSpec):
            yield GearPart(name, meshes[scene.meshes_of(name)[0]].gear(name), internal(part.expansion))


def _warnings(meshes: tuple[Mesh, ...]) -> Iterator[str]:
    for mesh in meshes:
        for name in (mesh.driver, mesh.driven):
            if warning := undercut_warning(mesh.gear(name)):
                yield f"{name}: {warning}"


def _measure(name: str, spec: MeasureUnion, mesh: Mesh) -> Measure:
    gear = getattr(spec, "gear", None) or mesh.driven
    return Measure(
        name=name,
        kind=Backlash(spec.kind, mesh.name, gear, _reading(spec, mesh)),
        positions=_positions(spec, mesh),
        take=spec.take,
        lower_limit=None if spec.lower_limit is None else spec.lower_limit.internal,
        upper_limit=None if spec.upper_limit is None else spec.upper_limit.internal,
    )


def _reading(spec: MeasureSpec, mesh: Mesh) -> Reading:
    """What was said, or the whole face and all teeth of a cylinder, one tooth's middle section of a cone.

    A free turn goes from contact to contact, and both are read alike.
    """
    tapers = mesh.pair.arm_spread > 0.0
    read_at = spec.read_at or ("mean_section" if tapers else "face")
    contact: Literal["face", "section"] = "section" if read_at == "mean_section" else "face"
    return Reading(
        contact=contact,
        gap="section" if read_at == "face_contact" and spec.kind == "normal_backlash" else contact,
        teeth=spec.tooth or ("driven" if tapers else "all"),
    )


def _positions(spec: MeasureSpec, mesh: Mesh) -> Positions:
    if isinstance(spec.over, At):
        return Positions("at", 1, 1, spec.over.at.internal)
    if spec.over == "random":
        return Positions("random", mesh.pair.long_period_turns, 1)
    turns = 1 if spec.over == "turn" else mesh.pair.long_period_turns
    return Positions(spec.over, turns, turns * spec.positions)


def _published(scene: Scene) -> dict[str, dict[str, dict[str, object]]]:
    return {
        column: {
            measure: {
                **{key: quantity.internal for key, quantity in values.quantities().items()},
                **({"contributors": dict(values.contributors)} if values.contributors else {}),
            }
            for measure, values in measures.items()
        }
        for column, measures in scene.published.items()
    }
