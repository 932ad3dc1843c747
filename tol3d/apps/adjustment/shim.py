"""The thickness of shims for a wanted minimum of backlash: by the formula, and by the geometry.

The minimum at a thickness is that of a study of the scene with shims of that thickness, on the geometric method. All
studies share their draws (a draw depends on seed, contributor and trial only), so the minimum falls smoothly with the
thickness, and a secant finds where it is the one that is wanted.
"""

import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Final, Literal

from tol3d.apps.adjustment.shim_choice import (
    MINIMUM_WORDS,
    UM,
    Minimum,
    Shim,
    Shimmed,
    measure_of,
    mesh_of,
    shims_of,
    with_shims,
)
from tol3d.apps.adjustment.stock import NO_SHIM, SAME_THICKNESS, Step, Stock, nearest, thickness_text
from tol3d.errors import InputError, SceneError
from tol3d.gearing import meshes_of, shafts_in_bores
from tol3d.scene import Scene, ToleranceSpec
from tol3d.simulate import Execution, Overrides, run_scene, simulation_of, workers_for
from tol3d.study import AS_WRITTEN, Simulation

Rounding = Literal["down", "nearest"]
Tell = Callable[[str], None]

MOST_STEPS: Final = 20  # of the secant, which takes two or three
LEAST_CLOSING: Final = 0.02  # mm/mm of all shims together; a 5 deg cone has 0.06, and shims that cancel have none
GRINDING: Final = Step(0.001)  # mm; the paper's shims of 0.048 mm are of that step


@dataclass(frozen=True)
class ShimQuestion:
    """Options of a choice of shims.

    Args:
        target: the minimum of normal backlash [mm].
        measure: its name; None is the only one of a bevel mesh.
        shims: those whose thickness is chosen, see `shims_of`.
        minimum: statistic that is called the minimum.
        stock: available thicknesses.
        rounding: "down" never falls below the target; "nearest" takes the nearest thickness.
    """

    target: float
    measure: str | None = None
    shims: tuple[str, ...] = ()
    minimum: Minimum = "low_3sigma"
    stock: Stock = GRINDING
    rounding: Rounding = "down"


@dataclass(frozen=True)
class ShimPlan:
    """The answer to a question.

    Args:
        scene: with shims of the chosen thickness.
        question: options of the choice.
        measure: whose minimum it is.
        shims: whose thickness it is, as they were.
        before: the scene as it stands.
        by_formula, by_geometry: the thickness before rounding, either way.
        chosen: that of the stock which is taken.
        other: its neighbour on the other side of `by_geometry`; None where there is none or its teeth interfere.
    """

    scene: Scene
    question: ShimQuestion
    measure: str
    shims: tuple[Shim, ...]
    before: Shimmed
    by_formula: Shimmed
    by_geometry: Shimmed
    chosen: Shimmed
    other: Shimmed | None

    @property
    def tolerances(self) -> Mapping[str, ToleranceSpec]:
        """Tolerances of the shims at the chosen thickness."""
        return {shim.name: self.scene.distributed[shim.name] for shim in self.shims}


def shim_plan(
    scene: Scene, question: ShimQuestion, overrides: Overrides = AS_WRITTEN, tell: Tell = lambda text: None
) -> ShimPlan:
    """Find the thickness of shims with which a measure has the wanted minimum.

    Args:
        scene: as `load` gives it.
        question: options of the choice.
        overrides: values that replace those of the scene's study.
        tell: callback that gets the current activity, in words.

    Raises:
        InputError: no such measure or shims, or no thickness that gives that minimum.
    """
    if question.target < 0.0:
        raise InputError(
            f"--target-min: expected a backlash of 0 or more, got {_um_text(question.target)}: "
            "builds with less than that have teeth that interfere"
        )
    search = _Search(scene, question, measure_of(scene, question.measure), replace(overrides, witness=0), tell)
    search.refuse_what_shims_cannot_change()
    by_formula = search.by_formula()
    by_geometry = search.solved(by_formula)
    chosen, other = _stocked(question, closing_of(search.shims), by_geometry.thickness or NO_SHIM)
    return ShimPlan(
        scene=with_shims(scene, search.shims, chosen),
        question=question,
        measure=search.measure,
        shims=search.shims,
        before=search.before,
        by_formula=by_formula,
        by_geometry=by_geometry,
        chosen=search.at(chosen),
        other=search.neighbour(other),
    )


def formula_thickness(excess: float, shims: Sequence[Shim]) -> float:
    """Thickness of every shim [mm] that takes up the excess of a backlash [mm], by the stack-up.

    excess / sum of 2 sin(alpha_w) sin(delta), from the mean thicknesses that the shims have on.
    """
    taken_now = sum(shim.closing * shim.mean for shim in shims)
    return (excess + taken_now) / closing_of(shims)


def closing_of(shims: Sequence[Shim]) -> float:
    """Normal backlash that a thickness of every shim takes together, to first order [mm/mm]."""
    return sum(shim.closing for shim in shims)


def _stocked(question: ShimQuestion, closing: float, thickness: float) -> tuple[float, float | None]:
    """The thickness of the stock to take [mm], and its neighbour on the other side of the wanted one.

    Raises:
        InputError: shims that open, and the stock has none so thick.
    """
    stock = question.stock
    below, above = stock.below(thickness), stock.above(thickness)
    if question.rounding == "nearest":
        chosen = nearest(stock, thickness)
        return chosen, above if chosen == below else below
    if closing > 0.0 or abs(below - thickness) < SAME_THICKNESS:
        return below, above
    if above is None:
        raise InputError(
            f"--stock: expected stacks of {thickness_text(thickness)} or more, for these shims open the mesh; "
            f"got {thickness_text(below)} at most"
        )
    return above, below


@dataclass(frozen=True)
class _Search:
    """Studies of a scene with shims of any thickness."""

    scene: Scene
    question: ShimQuestion
    measure: str
    overrides: Overrides
    tell: Tell

    @cached_property
    def simulation(self) -> Simulation:
        """The scene as it stands."""
        return simulation_of(self.scene, self.overrides)

    @cached_property
    def shims(self) -> tuple[Shim, ...]:
        """Whose thickness is looked for.

        Raises:
            SceneError: shafts of the gears lie in bores, which deviate too.
        """
        for move, shaft in shafts_in_bores(self.simulation.system):
            words = f"expected gears whose shafts lie in no bores, got {shaft!r} in those of a part"
            raise self.scene.refuse(("moves", move), f"{words}: shims are chosen for gears alone")
        mesh = meshes_of(self.simulation.system)[mesh_of(self.scene, self.measure)]
        return shims_of(self.scene, mesh, self.question.shims)

    @cached_property
    def before(self) -> Shimmed:
        """The scene as it stands."""
        return self._study(self.scene, self.overrides, None)

    def refuse_what_shims_cannot_change(self) -> None:
        """Refuse a study without geometry, and shims that undo each other.

        Raises:
            InputError: either.
        """
        if not self.simulation.has_geometry:
            raise InputError(
                "engine: expected exact or fcl, for the thickness is found by the geometry, got analytic; "
                "say --engine exact"
            )
        if abs(closing_of(self.shims)) < LEAST_CLOSING:
            names = ", ".join(repr(shim.name) for shim in self.shims)
            raise InputError(f"--shims: expected shims that close or open the mesh together, got {names}, which cancel")

    def by_formula(self) -> Shimmed:
        """Shims by the formula, or none where that is less than nothing."""
        excess = self.before.minimum - self.question.target
        return self.at(max(NO_SHIM, formula_thickness(excess, self.shims)))

    def solved(self, here: Shimmed) -> Shimmed:
        """Shims with the wanted minimum, by secant steps from a thickness nearby.

        Raises:
            InputError: they would have to be thinner than nothing.
        """
        slope = by_formula = -closing_of(self.shims)
        for _ in range(MOST_STEPS):
            excess, thickness = here.minimum - self.question.target, here.thickness or NO_SHIM
            if abs(excess) <= here.resolution:
                return here
            wanted = max(NO_SHIM, thickness - excess / slope)
            if wanted == thickness:
                raise self._thinner_than_nothing(here)
            there = self.at(wanted)
            steepness = (there.minimum - here.minimum) / (wanted - thickness)
            slope = steepness if 0.5 < steepness / by_formula < 2.0 else by_formula
            here = there
        raise InputError(
            f"{self.measure}: no thickness found with a minimum ({MINIMUM_WORDS[self.question.minimum]}) of "
            f"{_um_text(self.question.target)}; the nearest is {_um_text(here.minimum)} at {_text(here.thickness)}"
        )

    def _thinner_than_nothing(self, bare: Shimmed) -> InputError:
        target, short = self.question.target, abs(self.question.target - bare.minimum)
        called = f"the minimum ({MINIMUM_WORDS[self.question.minimum]}) of {self.measure!r} without shims"
        each = _text(short / sum(abs(shim.closing) for shim in self.shims))
        if closing_of(self.shims) > 0.0:
            return InputError(
                f"--target-min: expected at most {_um_text(bare.minimum)}, {called}, got {_um_text(target)}: the teeth "
                f"are too tight by {_um_text(short)}, and shims behind a gear only close; {each} in front of each "
                "(side: in_front) would open as much"
            )
        return InputError(
            f"--target-min: expected at least {_um_text(bare.minimum)}, {called}, got {_um_text(target)}: the teeth "
            f"are too loose by {_um_text(short)}, and these shims open; {each} behind each gear would close as much"
        )

    def neighbour(self, thickness: float | None) -> Shimmed | None:
        """Shims of the next thickness; None where there is none, or the teeth interfere."""
        try:
            return None if thickness is None else self.at(thickness)
        except InputError:
            return None

    def at(self, thickness: float) -> Shimmed:
        """Shims of a thickness [mm], the same trials as before.

        Raises:
            InputError: the teeth interfere, or no trial has a backlash to measure.
        """
        self.tell(f"shims of {_text(thickness)}")
        own = replace(self.overrides, trials=self.before.trials)
        try:
            return self._study(with_shims(self.scene, self.shims, thickness), own, thickness)
        except SceneError as error:
            raise InputError(f"with shims of {_text(thickness)}: {error}") from None

    def _study(self, scene: Scene, overrides: Overrides, thickness: float | None) -> Shimmed:
        execution = Execution(workers_for(self.simulation), keep_trials=False)
        with tempfile.TemporaryDirectory(prefix="tol3d-") as folder:
            run = run_scene(scene, overrides=overrides, out=Path(folder) / "run", execution=execution)
        measure, called = run.found.measures[self.measure], self.question.minimum
        found = measure.geometric
        if found is None or found.value(called) is None:
            raise InputError(f"{self.measure}: none of {run.trials} builds can be measured ({_text(thickness)})")
        return Shimmed(thickness, called, measure, found, run.trials)


def _um_text(length: float) -> str:
    return f"{UM * length:.3f} µm"


def _text(thickness: float | None) -> str:
    return "the scene as it stands" if thickness is None else thickness_text(round(thickness, 5))
