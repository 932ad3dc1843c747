"""Order for a run: a scene, and the values that override it."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from tol3d.errors import InputError
from tol3d.scene import Scene
from tol3d.scene.implausible import warned
from tol3d.scene.options import THEORY, Engines
from tol3d.scene.problems import problem_sentence, word_expected
from tol3d.study.system.dependent import in_draw_order
from tol3d.study.system.faults import faults_of, require_whole
from tol3d.study.system.mechanism import mechanism_of, origin_of, requires_of
from tol3d.study.system.other_laws import LEAST_OFF
from tol3d.study.system.system import System
from tol3d.study.trials.correlated import copula_of
from tol3d.study.trials.simulation import Simulation, lines_of, study_of
from tol3d.study.trials.study import Study


@dataclass(frozen=True)
class Overrides:
    """Values of a run that override its scene's study; None keeps the scene's."""

    trials: int | str | None = None
    seed: int | None = None
    engine: str | None = None
    sampler: str | None = None
    witness: int | None = None


AS_WRITTEN = Overrides()


def simulation_of(scene: Scene, overrides: Overrides = AS_WRITTEN) -> Simulation:
    """Simulation of a scene, with a run's overrides in its study.

    Raises:
        SceneError: the scene cannot be built, or its parts overlap at the mean build.
        InputError: an override that no scene could say.
        MechanismError: a mechanism of another package is at fault.
    """
    mechanism = mechanism_of(scene)
    _refuse_engine(scene, overrides, overrides.engine or scene.study.engine, mechanism.engines)
    asked = _overridden(scene, overrides)
    with faults_of(mechanism.origin):
        system = mechanism.system_of(asked)
        require_whole(system)
        in_draw_order(system.contributors)
    _refuse_engine(scene, overrides, asked.study.engine, system.methods)
    if asked.study.witness and not any(kind.witness for kind in system.methods.values()):
        sentence = f"expected none, for this scene has no witness, got {asked.study.witness}"
        if overrides.witness is None:
            raise asked.refuse(("study", "witness"), sentence)
        raise InputError(f"{_said_by('witness')}: {sentence}")
    with faults_of(mechanism.origin):
        problem = next(iter(system.problems()), None)
        implausible = (*scene.grammar.warnings(scene), *_unphysical(scene, system))
    if problem:
        raise scene.refuse(*problem)
    return Simulation(
        system,
        study_of(asked),
        asked.published,
        requires=requires_of(asked),
        presenter=mechanism.presenter,
        mechanism=origin_of(asked),
        implausible=implausible,
        copula=copula_of(asked, system),
        lines=lines_of(asked, system.contributors),
    )


def _unphysical(scene: Scene, system: System) -> Iterator[str]:
    """Warnings of laws that reach below the least physical deviation, such as a negative clearance or play."""
    for contributor in system.contributors:
        if contributor.least is not None and (low := contributor.distribution.low) < contributor.least - LEAST_OFF:
            least = contributor.least / contributor.per_unit
            words = f"expected at least {least:g} {contributor.unit}, for less is not physical"
            yield warned(
                scene.origin,
                ("tolerances", contributor.name),
                f"{words}, got down to {low / contributor.per_unit:.4g} {contributor.unit}",
            )


def asked_study(scene: Scene, overrides: Overrides = AS_WRITTEN) -> Study:
    """Study that a run of a scene is asked for, without interpreting the scene.

    Raises:
        InputError: an override that no scene could say.
    """
    _refuse_engine(scene, overrides, overrides.engine or scene.study.engine, mechanism_of(scene).engines)
    return study_of(_overridden(scene, overrides))


def _refuse_engine(scene: Scene, overrides: Overrides, engine: str, known: Iterable[str]) -> None:
    """Refuse an engine that the scene does not have, if it was asked for."""
    names = [*(name for name in known if name != THEORY), THEORY]
    if engine in names:
        return
    sentence = f"{word_expected(engine, names)}; these are the engines of this scene"
    if overrides.engine is None:
        raise scene.refuse(("study", "engine"), sentence)
    raise InputError(f"{_said_by('engine')}: {sentence}")


def _said_by(option: str) -> str:
    """Option of a run that overrides its scene, in words."""
    return f"--{option} (in Python Overrides.{option})"


def _overridden(scene: Scene, overrides: Overrides) -> Scene:
    """The scene with another study, as if it had been written so."""
    given = {key: value for key, value in vars(overrides).items() if value is not None}
    kept = scene.study.model_fields_set - _unsaid_by(given, scene.study.engines)
    said = {name: getattr(scene.study, name) for name in kept}
    try:
        study = type(scene.study).model_validate(said | given)
    except ValidationError as error:
        details = error.errors(include_url=False)[0]
        place = ".".join(str(key) for key in details["loc"][:1]) or details.get("ctx", {}).get("field") or "study"
        where = _said_by(place) if place in given else f"study.{place}"
        raise InputError(f"{where}: {problem_sentence(details)}") from None
    return scene.model_copy(update={"study": study})


def _unsaid_by(given: Mapping[str, Any], engines: Engines) -> set[str]:
    """Settings of the scene's study that hold only for other trials, another sampler or another engine."""
    unsaid = {"until", "at_most"} if given.get("trials", "auto") != "auto" else set()
    unsaid |= {"replicates"} if given.get("sampler") == "monte_carlo" else set()
    return unsaid | ({"witness"} if given.get("engine") in engines.unwitnessed else set())
