"""What a run is asked to do: a scene, and what is said otherwise than there."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from tol3d.errors import InputError, SceneError
from tol3d.gearing.model import Backlash, LostMotion, Measure, Model, model_from_scene
from tol3d.gearing.model.measure import ParallelStage
from tol3d.kinds import load_scene
from tol3d.scene import Scene, scene_from_python
from tol3d.study.block import analytic_backlashes, analytic_play, mean_block, nominal_block

ZERO_BACKLASH = 1e-9  # mm or rad; nominal backlash zero is legal, and closed forms round to 1e-14


@dataclass(frozen=True)
class Overrides:
    """What a run may say otherwise than its scene's study; None keeps the scene's word."""

    trials: int | str | None = None
    seed: int | None = None
    engine: str | None = None
    sampler: str | None = None
    witness: int | None = None


AS_WRITTEN = Overrides()


def load(scene: Scene | Path | str, *, trust_parts: bool = False) -> Scene:
    """A scene from a path or a bundled name, or the scene itself; one made in Python is checked first."""
    if not isinstance(scene, Scene):
        return load_scene(scene, trust_parts=trust_parts)
    return scene if scene.text else scene_from_python(scene, trust_parts=trust_parts)


def effective_model(scene: Scene, overrides: Overrides = AS_WRITTEN) -> Model:
    """The model of a scene with a run's overrides in its study; refuses a mean build that interferes.

    Raises:
        SceneError: the scene cannot be built, or interferes.
        InputError: an override that no scene could say.
    """
    model = model_from_scene(_overridden(scene, overrides))
    refuse_interfering_mean(scene, model)
    return model


def _overridden(scene: Scene, overrides: Overrides) -> Scene:
    """The scene with another study, as if it had been written so."""
    given = {key: value for key, value in vars(overrides).items() if value is not None}
    said = {name: getattr(scene.study, name) for name in scene.study.model_fields_set - _unsaid_by(given)}
    try:
        study = type(scene.study).model_validate(said | given)
    except ValidationError as error:
        details = error.errors(include_url=False)[0]
        place = ".".join(str(key) for key in details["loc"][:1]) or details.get("ctx", {}).get("field") or "study"
        got = "" if details["type"] == "value_refused" else f", got {details['input']!r}"
        raise InputError(f"{place}, otherwise than in the scene: {details['msg']}{got}") from None
    return scene.model_copy(update={"study": study})


def _unsaid_by(given: Mapping[str, Any]) -> set[str]:
    """What the scene's study says for other trials, another sampler or another engine only."""
    unsaid = {"until", "at_most"} if given.get("trials", "auto") != "auto" else set()
    unsaid |= {"replicates"} if given.get("sampler") == "monte_carlo" else set()
    return unsaid | ({"witness"} if given.get("engine", "exact") != "exact" else set())


def refuse_interfering_mean(scene: Scene, model: Model) -> None:
    """Refuse a mesh whose non-working flanks overlap with every contributor at its mean, and ways that bind then.

    Raises:
        SceneError: at the mesh with its backlash, or at the train of the ways, of nominal and mean build.
    """
    for measure in model.measures:
        mean, nominal = mean_block(model, measure), nominal_block(model)
        for backlash, values in analytic_backlashes(model, measure, mean):
            if float(values.min()) < -ZERO_BACKLASH:
                before = dict(analytic_backlashes(model, measure, nominal))[backlash]
                raise _interfering(scene, model, measure, backlash, (float(values.min()), float(before.min())))
        if isinstance(measure.kind, LostMotion) and analytic_play(model, measure, mean).bound().any():
            raise _binding(scene, model, measure, measure.kind)


def _interfering(
    scene: Scene, model: Model, measure: Measure, backlash: Backlash, mean_and_nominal: tuple[float, float]
) -> SceneError:
    mesh = model.mesh(backlash.mesh)
    name = measure.name if measure.kind == backlash else f"the angular backlash of {backlash.gear}"
    own = replace(measure, kind=backlash)
    mean, nominal = (value * own.per_internal for value in mean_and_nominal)
    return scene.refuse(
        ("moves", mesh.name),
        f"the teeth interfere at the mean build: {name} is {mean:.3f} {own.unit} there "
        f"(nominal {nominal:.3f} {own.unit}); {mesh.pair.remedy}",
    )


def _binding(scene: Scene, model: Model, measure: Measure, kind: LostMotion) -> SceneError:
    ways = ", ".join(stage.link for stage in kind.stages if isinstance(stage, ParallelStage))
    angle = replace(measure, kind=replace(kind, quantity="lost_motion", tip=None, turned=()))
    mean, nominal = (
        float(analytic_play(model, angle, block).free().min()) * angle.per_internal
        for block in (mean_block(model, angle), nominal_block(model))
    )
    return scene.refuse(
        ("moves", kind.train),
        f"the parallel ways {ways} bind each other at the mean build: the lost motion of {kind.shaft} is {mean:.3f} "
        f"{angle.unit} there (nominal {nominal:.3f} {angle.unit}); thin the teeth, or set the gears otherwise on their "
        "shafts",
    )
