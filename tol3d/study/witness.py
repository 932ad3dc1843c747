"""The witness: some of a study's trials made again and measured by FCL, on strips of the CAD solids.

A strip's chords lie inside the tooth, by the chord error at most: FCL sees up to four of them more backlash than
there is, for two flanks touch and two are measured. The trials are drawn by a stream of their own, so they are the
same whoever ran the study and whatever it kept.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.engines import Engine
from tol3d.gearing.model import Measure, Model
from tol3d.gearing.stack_up import first_order, per_normal_backlash
from tol3d.runs.outcome import status_column
from tol3d.samplers.monte_carlo import uniforms
from tol3d.study.block import Block, Columns, drawn_block, simulate_block
from tol3d.study.task import fcl_engine, strips_of

Array = NDArray[np.float64]

STREAM = ("witness", "trial")
FLANKS_OF_A_BACKLASH = 4  # two that touch, two that are measured
ALLOWANCE = 0.02e-3
"""What FCL may be off besides chord errors, in modules: an edge whose normal lies far off the contact's (0.0073 um a
millimetre of module at 0.46 rad, as a tip reaches a flank a fifth of a pitch beyond the path of contact), its own
rounding (0.002 um a millimetre), and squares of tilts within a section's width. 0.05 um at module 2.5."""
NOTHING_COMPARED = {
    "max_abs_difference": None,
    "mean_difference": None,
    "rms_difference": None,
    "trial_of_the_largest": None,
    "compared": 0,
}


def witness_summary(model: Model, engine: Engine, trials: int) -> dict[str, Any]:
    """What FCL finds of `study.witness` trials of a run, as summary.json shows it.

    Args:
        model: of the run, whose study names a witness.
        engine: measured the run.
        trials: how many trials the run has.

    Returns:
        the differences FCL - engine of each measure, in its unit, and what chord errors explain of them.
    """
    chosen = witnessed_trials(model.study.seed, trials, model.study.witness)
    block = _made_again(model, chosen)
    strips = strips_of(model)
    fcl = fcl_engine(model, strips)
    chords = {mesh.name: max(strips[gear].chord_error for gear in (mesh.driver, mesh.driven)) for mesh in model.meshes}
    expected = {name: FLANKS_OF_A_BACKLASH * chord for name, chord in chords.items()}
    allowed = {mesh.name: ALLOWANCE * mesh.pair.pinion.module for mesh in model.meshes}
    seen, given = simulate_block(model, fcl, block), simulate_block(model, engine, block)
    return {
        "engine": "fcl",
        "trials": len(chosen),
        "chord_error_um": 1000 * fcl.chord_error,
        "profile_steps": model.study.profile_steps,
        "measures": {
            measure.name: {
                **_differences(_difference(seen, given, measure), chosen),
                "expected_at_most": _of_gaps(model, measure, expected),
                "allowance": _of_gaps(model, measure, allowed),
            }
            for measure in model.measures
        },
        "status_differences": int(np.count_nonzero(seen["status"] != given["status"])),
    }


def witness_warnings(model: Model, witness: Mapping[str, Any]) -> list[str]:
    """A sentence for each measure that differs by more than is explained, and one for trials of another status."""
    units = {measure.name: measure.unit for measure in model.measures}
    found = [
        f"witness: FCL finds {own['max_abs_difference']:.3g} {units[name]} more or less {name} of trial "
        f"{own['trial_of_the_largest']}; its chords explain {own['expected_at_most']:.3g} {units[name]}, its other "
        f"errors {own['allowance']:.3g} {units[name]}"
        for name, own in witness["measures"].items()
        if (own["max_abs_difference"] or 0.0) > own["expected_at_most"] + own["allowance"]
    ]
    if other := witness["status_differences"]:
        found.append(f"witness: by FCL {other} of {witness['trials']} trials end with another status")
    return found


def witnessed_trials(seed: int, trials: int, wanted: int) -> NDArray[np.int64]:
    """Which trials of a study are measured again: distinct, ascending, all of them where there are no more.

    A function of the three numbers alone. Each set of `wanted` trials is as likely as any other: for every top from
    trials - wanted on, one of the trials up to it is taken, or the top itself where that one was taken before.
    Source: Bentley, Floyd, Programming pearls: a sample of brilliance (CACM 30(9), 1987).
    """
    count = min(wanted, trials)
    tops = range(trials - count, trials)
    chosen: set[int] = set()
    for top, u in zip(tops, uniforms(seed, *STREAM, 0, count).tolist(), strict=True):
        drawn = int(u * (top + 1))
        chosen.add(top if drawn in chosen else drawn)
    return np.array(sorted(chosen), dtype=np.int64)


def _made_again(model: Model, chosen: NDArray[np.int64]) -> Block:
    """The draws of these trials."""
    return _joined([drawn_block(model, model.study.seed, trial, 1) for trial in chosen.tolist()])


def _joined(blocks: Sequence[Block]) -> Block:
    return Block(
        np.concatenate([block.deviations for block in blocks]),
        {mesh: np.concatenate([block.random_angle[mesh] for block in blocks]) for mesh in blocks[0].random_angle},
    )


def _difference(seen: Columns, given: Columns, measure: Measure) -> Array:
    """By how much two engines differ, (trials,) or (trials, positions); nan where trials end with another status.

    A train that is jammed by one engine only differs by all of its other stages' play.
    """
    column = f"geometric:{measure.name}"
    difference = np.asarray(seen[column], dtype=np.float64) - np.asarray(given[column], dtype=np.float64)
    status = status_column(measure.name)
    difference[seen[status] != given[status]] = np.nan
    return difference


def _differences(difference: Array, chosen: NDArray[np.int64]) -> dict[str, float | int | None]:
    """Differences of some trials, (trials,) or of a curve (trials, positions); nan where either has no value."""
    each = difference.reshape(len(chosen), -1)
    known = ~np.isnan(each)
    compared = int(np.count_nonzero(known.any(axis=1)))
    if not compared:
        return dict(NOTHING_COMPARED)
    size = np.where(known, np.abs(each), -1.0)
    return {
        "max_abs_difference": float(size.max()),
        "mean_difference": float(each[known].mean()),
        "rms_difference": float(np.sqrt((each[known] ** 2).mean())),
        "trial_of_the_largest": int(chosen[size.max(axis=1).argmax()]),
        "compared": compared,
    }


def _of_gaps(model: Model, measure: Measure, normal_backlash: Mapping[str, float]) -> float:
    """What a measure makes of normal backlashes [mm], one of each mesh, in its unit."""
    free = sum(
        factor * normal_backlash[backlash.mesh] * per_normal_backlash(model, backlash)
        for factor, backlash in measure.kind.backlashes
    )
    positions = np.full((1, max(1, len(measure.positions.fixed or ()))), free)
    return float(first_order(measure.kind, positions).max()) * measure.per_internal
