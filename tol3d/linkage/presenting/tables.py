"""Tables of a closed loop without deviations."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from tol3d.assembly.model import Assembly
from tol3d.errors import InputError
from tol3d.linkage.kinematics import Kinematics, Position, UnreachedError
from tol3d.linkage.loop import ClosedLoop, Closing, LoopInput
from tol3d.linkage.structure import FREEDOMS
from tol3d.linkage.workspace import range_of
from tol3d.report.page import Heading, PageItem, Row, Table, note, titled

TILTS: Final = 10.0
"""Step of the table of inputs [deg]."""
AZIMUTHS: Final = (0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0)
STEPS: Final = 5
"""Values of each input in the table of outputs."""
MOST_ROWS: Final = 64
CONDITION: Final = (
    "condition: of the equations of all joints with lengths as shares of {length:.4g} mm; it grows without bound "
    "towards a singular pose"
)


def loop_blocks(plan: Closing, assembly: Assembly) -> Sequence[PageItem]:
    """Joints and freedoms, inputs, poses, and the relation of inputs and output."""
    move = plan.move
    return (*_freedoms(move), *_poses(move), *_inverse(move), *_forward(move))


def _freedoms(move: ClosedLoop) -> Sequence[PageItem]:
    own = move.structure
    rows = []
    for step in own.steps:
        joint, given = step.joint, [name for name, each in move.inputs.items() if each.joint == step.joint.name]
        rows.append(
            Row(
                joint.name,
                (
                    f"{joint.on} – {joint.of}",
                    ", ".join(FREEDOMS[joint.kind]) if joint.kind else "all turns",
                    ", ".join(given),
                    "shuts a loop" if step in own.shut else "",
                ),
            )
        )
    words = [Heading(word, words=True) for word in ("between", "freedoms", "inputs", "")]
    table = titled(f"{move.name}: joints", Table("", words, rows))
    free = int(own.free(inputs=False).max(initial=-1)) + 1
    idle = move.kinematics.idle_freedoms()
    told = (
        f"{len(own.bodies)} bodies; joints that place them leave {free + len(own.inputs)} freedoms, inputs give "
        f"{len(own.inputs)}, joints that shut loops take {own.rows}; "
        + (f"{len(idle)} idle, held as they are: {'; '.join(words for words, _ in idle)}" if idle else "none is left")
    )
    return (*table, note(told))


def _poses(move: ClosedLoop) -> Sequence[PageItem]:
    stations = move.stations or {"as placed": move.kinematics.drawn}
    tilts = _has_tilt(move.kinematics)
    heads = [*move.inputs, *(("tilt [deg]", "azimuth [deg]") if tilts else ()), "condition"]
    rows = []
    for name, at in stations.items():
        cells = [own.told(value) for own, value in _values(move, at)]
        rows.append(Row(name, (*cells, *(_direction(move.kinematics, at) if tilts else ()), f"{at.condition:.4g}")))
    table = titled(f"{move.name}: poses", Table("", [Heading(own) for own in heads], rows))
    return (*table, note(CONDITION.format(length=move.structure.length)))


def _values(move: ClosedLoop, at: Position) -> Sequence[tuple[LoopInput, float]]:
    values = move.kinematics.inputs_at(at)
    return [(own, values[name]) for name, own in move.inputs.items()]


def _has_tilt(kinematics: Kinematics) -> bool:
    output = kinematics.structure.output
    return output is not None and not output.whole


def _direction(kinematics: Kinematics, at: Position) -> tuple[str, str]:
    x, y = kinematics.tilt_at(at)
    tilt = np.degrees(np.hypot(x, y))
    azimuth = np.degrees(np.arctan2(-x, y)) % 360.0 if tilt > 1e-9 else 0.0
    return f"{tilt:.6g}", f"{azimuth:.6g}"


def _inverse(move: ClosedLoop) -> Sequence[PageItem]:
    """Inputs by tilt and azimuth, as far as the loop reaches."""
    if not _has_tilt(move.kinematics) or not move.inputs:
        return ()
    rows = []
    for azimuth in AZIMUTHS:
        angle, at, tilt = np.radians(azimuth), move.kinematics.drawn, TILTS
        while tilt < 180.0:
            try:
                vector = np.radians(tilt) * np.array([-np.sin(angle), np.cos(angle)])
                at = move.kinematics.at_output(vector, at)
            except UnreachedError as error:
                reached = _direction(move.kinematics, error.position)[0]
                rows.append(Row(f"{azimuth:g} deg", (f"up to {float(reached):.4g}", *[""] * len(move.inputs), "")))
                break
            cells = [own.told(value) for own, value in _values(move, at)]
            rows.append(Row(f"{azimuth:g} deg", (f"{tilt:g}", *cells, f"{at.condition:.4g}")))
            tilt += TILTS
    heads = ["tilt [deg]", *move.inputs, "condition"]
    table = Table("azimuth", [Heading(own) for own in heads], rows)
    return titled(f"{move.name}: inputs by the output (inverse)", table)


def _forward(move: ClosedLoop) -> Sequence[PageItem]:
    """The output by the inputs, over their ranges; by default those of the poses."""
    if not move.inputs or len(move.inputs) > 2 or not _has_tilt(move.kinematics):
        return ()
    try:
        ranges = [range_of(move, name) for name in move.inputs]
    except InputError:
        return ()
    rows = []
    for values in np.stack(np.meshgrid(*(np.linspace(*own, STEPS) for own in ranges), indexing="ij"), -1).reshape(
        -1, len(ranges)
    ):
        inputs = dict(zip(move.inputs, values.tolist(), strict=True))
        told = [own.told(value) for own, value in zip(move.inputs.values(), values, strict=True)]
        try:
            at = move.kinematics.at_inputs(inputs)
            cells = (*told[1:], *_direction(move.kinematics, at), f"{at.condition:.4g}")
        except UnreachedError:
            cells = (*told[1:], "not reached", "", "")
        rows.append(Row(told[0], cells))
    first, *others = move.inputs
    heads = [*others, "tilt [deg]", "azimuth [deg]", "condition"]
    table = Table(first, [Heading(own) for own in heads], rows[:MOST_ROWS])
    return titled(f"{move.name}: the output by the inputs (forward)", table)
