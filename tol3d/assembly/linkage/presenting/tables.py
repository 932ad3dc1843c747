"""Tables of a closed loop without deviations."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Final

import numpy as np

from tol3d.assembly.linkage.kinematics import Kinematics, Position, UnreachedError
from tol3d.assembly.linkage.loop import ClosedLoop, Closing
from tol3d.assembly.linkage.structure import FREEDOMS, Step
from tol3d.assembly.linkage.workspace import range_of
from tol3d.assembly.model import Assembly
from tol3d.errors import InputError
from tol3d.report.declared import declared_table
from tol3d.report.page import PageItem, note, titled
from tol3d.study.runs.summary.shows import Computed, Shows

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


@dataclass(frozen=True)
class JointRow:
    """A joint of a loop."""

    move: ClosedLoop
    step: Step
    between = Computed(Shows("between", "words"), lambda own: f"{own.step.joint.on} – {own.step.joint.of}")
    freedoms = Computed(
        Shows("freedoms", "words"),
        lambda own: ", ".join(FREEDOMS[own.step.joint.kind]) if own.step.joint.kind else "all turns",
    )
    inputs = Computed(
        Shows("inputs", "words"),
        lambda own: ", ".join(name for name, each in own.move.inputs.items() if each.joint == own.step.joint.name),
    )
    shuts = Computed(Shows("", "words"), lambda own: "shuts a loop" if own.step in own.move.structure.shut else "")


@dataclass(frozen=True)
class PoseRow:
    """A pose of a loop: its inputs in words, the direction of its output [deg], and the condition of its equations."""

    inputs: Annotated[Mapping[str, str], Shows("{key}")]
    tilt: Annotated[float | str | None, Shows("tilt [deg]", ".6g", seldom=True)]
    azimuth: Annotated[float | str | None, Shows("azimuth [deg]", ".6g", seldom=True)]
    condition: Annotated[float | str, Shows("condition", ".4g")]


@dataclass(frozen=True)
class InverseRow:
    """The inputs in words at a tilt of the output [deg], or how far it goes."""

    tilt: Annotated[float | str, Shows("tilt [deg]", "g")]
    inputs: Annotated[Mapping[str, str], Shows("{key}")]
    condition: Annotated[float | str, Shows("condition", ".4g")]


def _freedoms(move: ClosedLoop) -> Sequence[PageItem]:
    own = move.structure
    table = titled(
        f"{move.name}: joints", declared_table("", [(step.joint.name, JointRow(move, step)) for step in own.steps])
    )
    free = int(own.free(inputs=False).max(initial=-1)) + 1
    idle = move.kinematics.idle_freedoms
    told = (
        f"{len(own.bodies)} bodies; joints that place them leave {free + len(own.inputs)} freedoms, inputs give "
        f"{len(own.inputs)}, joints that shut loops take {own.rows}; "
        + (f"{len(idle)} idle, held as they are: {'; '.join(words for words, _ in idle)}" if idle else "none is left")
    )
    return (*table, note(told))


def _poses(move: ClosedLoop) -> Sequence[PageItem]:
    stations = move.stations or {"as placed": move.kinematics.drawn}
    rows = [(name, _pose(move, at, _told(move, at))) for name, at in stations.items()]
    table = titled(f"{move.name}: poses", declared_table("", rows))
    return (*table, note(CONDITION.format(length=move.structure.length)))


def _pose(move: ClosedLoop, at: Position, inputs: Mapping[str, str]) -> PoseRow:
    tilt, azimuth = _direction(move.kinematics, at) if _has_tilt(move.kinematics) else (None, None)
    return PoseRow(inputs, tilt, azimuth, at.condition)


def _told(move: ClosedLoop, at: Position) -> Mapping[str, str]:
    values = move.kinematics.inputs_at(at)
    return {name: own.told(values[name]) for name, own in move.inputs.items()}


def _has_tilt(kinematics: Kinematics) -> bool:
    output = kinematics.structure.output
    return output is not None and not output.whole


def _direction(kinematics: Kinematics, at: Position) -> tuple[float, float]:
    x, y = kinematics.tilt_at(at)
    tilt = float(np.degrees(np.hypot(x, y)))
    return tilt, float(np.degrees(np.arctan2(-x, y)) % 360.0) if tilt > 1e-9 else 0.0


def _inverse(move: ClosedLoop) -> Sequence[PageItem]:
    """Inputs by tilt and azimuth, as far as the loop reaches."""
    if not _has_tilt(move.kinematics) or not move.inputs:
        return ()
    rows: list[tuple[str, InverseRow]] = []
    for azimuth in AZIMUTHS:
        angle, at, tilt = np.radians(azimuth), move.kinematics.drawn, TILTS
        while tilt < 180.0:
            try:
                vector = np.radians(tilt) * np.array([-np.sin(angle), np.cos(angle)])
                at = move.kinematics.at_output(vector, at)
            except UnreachedError as error:
                reached = _direction(move.kinematics, error.position)[0]
                rows.append(
                    (f"{azimuth:g} deg", InverseRow(f"up to {reached:.4g}", dict.fromkeys(move.inputs, ""), ""))
                )
                break
            rows.append((f"{azimuth:g} deg", InverseRow(tilt, _told(move, at), at.condition)))
            tilt += TILTS
    return titled(f"{move.name}: inputs by the output (inverse)", declared_table("azimuth", rows))


def _forward(move: ClosedLoop) -> Sequence[PageItem]:
    """The output by the inputs, over their ranges; by default those of the poses."""
    if not move.inputs or len(move.inputs) > 2 or not _has_tilt(move.kinematics):
        return ()
    try:
        ranges = [range_of(move, name) for name in move.inputs]
    except InputError:
        return ()
    first, rows = next(iter(move.inputs)), list[tuple[str, PoseRow]]()
    for values in np.stack(np.meshgrid(*(np.linspace(*own, STEPS) for own in ranges), indexing="ij"), -1).reshape(
        -1, len(ranges)
    ):
        inputs = dict(zip(move.inputs, values.tolist(), strict=True))
        others = {name: own.told(inputs[name]) for name, own in move.inputs.items()}
        label = others.pop(first)
        try:
            rows.append((label, _pose(move, move.kinematics.at_inputs(inputs), others)))
        except UnreachedError:
            rows.append((label, PoseRow(others, "not reached", "", "")))
    return titled(f"{move.name}: the output by the inputs (forward)", declared_table(first, rows[:MOST_ROWS]))
