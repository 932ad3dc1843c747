"""A sweep: variants of a scene, each simulated by itself, with the same draws.

A contributor's draws depend on the seed, its name and the trial alone, so that variants differ by what is varied and
not by chance. Finished variants are kept, one run each without its trials: an interrupted sweep resumes.
"""

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Final

from pydantic import Field

from tol3d.analyses.variants import Number as Value
from tol3d.analyses.variants import Point, Variable, grid_of, hypercube_of, plain_number
from tol3d.errors import InputError, RunError, unwritable
from tol3d.report.verdict import ends_of
from tol3d.scene import Scene
from tol3d.scene.vary import known_path
from tol3d.simulate import Execution, run_simulation, simulation_of
from tol3d.study.execution.watch import UNWATCHED, Watch
from tol3d.study.runs.atomic_write import write_whole
from tol3d.study.runs.run import Run
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.shows import Shows
from tol3d.study.runs.summary.values import Count, Known, Label, Number, Ppm, PpmRange, Section, Sentence, made
from tol3d.study.system.outcome import SEATED
from tol3d.study.trials.overrides import AS_WRITTEN, Overrides, asked_study

NAME: Final = "sweep.json"


class VariantMeasure(Section):
    """Result of a variant's run for a measure, in its unit, by the 3D simulation if there is one."""

    unit: Label
    lower_limit: Known
    upper_limit: Known
    mean: Annotated[Known, Shows("mean")]
    sigma: Annotated[Known, Shows("sigma")]
    low: Annotated[Known, Shows("low")] = Field(
        description="mean - 3 sigma, or the 0.135 % quantile if trials end before; of a curve the lowest"
    )
    high: Annotated[Known, Shows("high")]
    out_ppm: Annotated[Ppm | None, Shows("out of limits", "share")]
    out_ppm_95: PpmRange | None
    ppk: Annotated[Known, Shows("Ppk", ".2f")]
    failed: Annotated[Count, Shows("not assembled", "d")]


class Variant(Section):
    """One of a sweep."""

    values: list[Label] = Field(description="of the fields, as they stand in its scene")
    numbers: list[Number] = Field(description="the same in `units`")
    run: Label | None = Field(description="its folder; null where it could not be built")
    reason: Sentence | None = Field(description="why it could not be built")
    measures: Mapping[Label, VariantMeasure]


class Sweep(Section):
    """Variants of a scene."""

    scene: Label
    fields: list[Label]
    units: list[str]
    trials: Count
    seed: Count
    variants: list[Variant]


@dataclass(frozen=True)
class SweepQuestion:
    """Variables of a sweep.

    Args:
        variables: fields with their values, or with ranges for a Latin hypercube.
        latin_hypercube: how many variants are drawn; None for a grid.
        seed: of these, not of the trials.
    """

    variables: tuple[Variable, ...]
    latin_hypercube: int | None = None
    seed: int = 1

    @property
    def points(self) -> list[Point]:
        """The variants.

        Raises:
            InputError: see grid_of and hypercube_of.
        """
        if self.latin_hypercube is None:
            return grid_of(self.variables)
        return hypercube_of(self.variables, self.latin_hypercube, self.seed)


@dataclass(frozen=True)
class Order:
    """Simulation settings of variants.

    Args:
        out: the folder that keeps them.
        overrides: changes to the scene's study, for all of them.
        workers: that run the trials of one.
        trust_parts, run_builders: see `tol3d.run_scene`.
        watch: callbacks while one runs.
        done: callback before the first and after each variant: the number done, the number of all, and values.
    """

    out: Path
    overrides: Overrides = AS_WRITTEN
    workers: int = 1
    trust_parts: bool = False
    run_builders: bool = False
    watch: Watch = UNWATCHED
    done: Callable[[int, int, str], None] = lambda number, count, words: None


def sweep(scene: Scene, question: SweepQuestion, order: Order) -> Sweep:
    """Simulate all variants of a scene, those that are kept from before but for their tables.

    Args:
        scene: as `load` gives it.
        question: the variables.
        order: how they are simulated.

    Raises:
        InputError: a field that does not exist, invalid values, or a folder that cannot be written.
    """
    points, order = question.points, replace(order, overrides=replace(order.overrides, witness=0))
    study = asked_study(scene, order.overrides)
    _refuse_all(scene, points[0], order.out)
    variants = []
    order.done(0, len(points), words_of(points[0]))
    for k, point in enumerate(points):
        variants.append(_variant(scene, point, order))
        order.done(k + 1, len(points), words_of(point))
    return made(
        Sweep,
        scene=scene.scene,
        fields=[variable.field for variable in question.variables],
        units=[variable.unit for variable in question.variables],
        trials=study.trials,
        seed=study.seed,
        variants=variants,
    )


def words_of(point: Point) -> str:
    """The values of a variant, for people."""
    return ", ".join(f"{field} = {value}" for field, value in point.items())


def write_text(text: str, path: Path) -> None:
    """Write a file of a sweep.

    Raises:
        InputError: it cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, text.encode())
    except OSError as error:
        raise unwritable(path, error, "choose another folder") from None


def _refuse_all(scene: Scene, point: Point, out: Path) -> None:
    """Refuse errors common to all variants: a field that does not exist, a folder that cannot be written."""
    for field in point:
        known_path(scene, field)
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(out, error, "choose another --out") from None


def _variant(scene: Scene, point: Point, order: Order) -> Variant:
    values, numbers = [_text(own) for own in point.values()], [plain_number(own) for own in point.values()]
    try:
        changed = scene.with_(
            {field: _written(own) for field, own in point.items()},
            trust_parts=order.trust_parts,
            run_builders=order.run_builders,
        )
        run = _run(changed, order)
    except RunError:
        raise
    except InputError as error:
        reason = " ".join(str(error).split())
        return made(Variant, values=values, numbers=numbers, run=None, reason=reason, measures={})
    measures = {name: _found(own) for name, own in run.found.measures.items()}
    return made(Variant, values=values, numbers=numbers, run=run.path.name, reason=None, measures=measures)


def _text(value: Value) -> str:
    return str(value)


def _written(value: Value) -> Any:
    """As a scene has it."""
    return value if isinstance(value, int | float) else str(value)


def _run(scene: Scene, order: Order) -> Run:
    """The variant's run; an earlier one if it is complete."""
    simulation = simulation_of(scene, order.overrides)
    folder = order.out / f"variant-{_key(scene, simulation.study)}"
    kept = Execution(order.workers, keep_trials=False, resume=True)
    try:
        return run_simulation(scene, simulation, folder, execution=kept, watch=order.watch)
    except RunError:  # of other versions or another machine, or damaged
        anew = replace(kept, resume=False)
        return run_simulation(scene, simulation, folder, execution=anew, force=True, watch=order.watch)


def _key(scene: Scene, study: object) -> str:
    """Key that distinguishes variants of one sweep from each other, and from others in the same folder."""
    digest = hashlib.sha256(scene.text.encode())
    for name, file in sorted(scene.files.items()):
        digest.update(f"{name} {file.sha256}".encode())
    digest.update(repr(study).encode())
    return digest.hexdigest()[:12]


def _found(measure_summary: MeasureSummary) -> VariantMeasure:
    low, mean, high = ends_of(measure_summary)
    sample = measure_summary.sample(measure_summary.best_method) if measure_summary.take != "curve" else None
    return made(
        VariantMeasure,
        unit=measure_summary.unit,
        lower_limit=measure_summary.lower_limit,
        upper_limit=measure_summary.upper_limit,
        mean=mean,
        sigma=sample.sigma if sample is not None else None,
        low=low,
        high=high,
        out_ppm=measure_summary.shares.out_ppm
        if measure_summary.has_limits or measure_summary.shares.out_ppm
        else None,
        out_ppm_95=measure_summary.shares.out_ppm_95
        if measure_summary.has_limits or measure_summary.shares.out_ppm
        else None,
        ppk=measure_summary.shares.ppk,
        failed=measure_summary.trials - measure_summary.status.get(SEATED, measure_summary.trials),
    )


def measures_of(found: Sweep) -> Sequence[str]:
    """Names of all measures of all variants."""
    return list(dict.fromkeys(name for variant in found.variants for name in variant.measures))
