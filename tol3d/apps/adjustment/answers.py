"""Shims for a notebook or a script, as `tol3d shim` finds them."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tol3d.apps.adjustment.shim import Rounding, ShimPlan, ShimQuestion, shim_plan
from tol3d.apps.adjustment.shim_choice import Minimum
from tol3d.apps.adjustment.shim_table import shim_report
from tol3d.apps.adjustment.stock import length_of, stock_of
from tol3d.report.printed import Report
from tol3d.scene import Scene, tolerance_lines
from tol3d.simulate import Overrides, load
from tol3d.study import AS_WRITTEN


@dataclass(frozen=True, repr=False)
class Shims(Report):
    """The thickness of shims for a wanted minimum of backlash.

    Args:
        plan: the answer in numbers; `plan.scene` is the scene with the chosen shims.
    """

    plan: ShimPlan

    @property
    def tolerances(self) -> str:
        """The tolerances of the chosen shims, to paste into a scene."""
        return tolerance_lines(self.plan.tolerances)


def find_shims(
    scene: Scene | Path | str,
    target_min: str,
    *,
    measure: str | None = None,
    shims: Sequence[str] = (),
    minimum: Minimum = "low_3sigma",
    stock: str = "0.001 mm",
    rounding: Rounding = "down",
    overrides: Overrides = AS_WRITTEN,
    trust_parts: bool = False,
    run_builders: bool = False,
) -> Shims:
    """The thickness of shims with which a bevel pair has a wanted minimum of backlash, as `tol3d shim` finds it.

    Args:
        scene: a scene, its path, or the name of a bundled one.
        target_min: the minimum with its unit, such as "24 um".
        measure: whose minimum; the only normal backlash of a bevel mesh.
        shims: names of the scene's shims, or of gears for a new one behind each.
        minimum: which number is called so.
        stock: thicknesses there are: a step, or pieces with commas between them.
        rounding: "down" never falls below the target, "nearest" takes the nearest thickness.
        overrides: values that replace those of the scene's study.
        trust_parts: allow files outside the scene's folder.
        run_builders: run the Python files that the scene names as builders of its parts.

    Raises:
        InputError: no such measure or shims, or no thickness that gives that minimum.
    """
    target = length_of("target_min", target_min)
    question = ShimQuestion(target, measure, tuple(shims), minimum, stock_of(stock), rounding)
    plan = shim_plan(load(scene, trust_parts=trust_parts, run_builders=run_builders), question, overrides)
    return Shims(shim_report(plan), plan)
