"""The linear programme of one-sided contacts at a pose, and motions from there, in kernels."""

from typing import Any

from tol3d.assembly.placing.one_sided_gaps import restored, rows_at, tangents_at
from tol3d.assembly.placing.pose_steps import stepped
from tol3d.numerics.compiled import nested


@nested
def motion_rows(pose: Any, trial: Any, reach: float, pull: Any, found: Any) -> None:
    """How gaps change with the motions that keep what is kept (contacts, motions), and what the force does (motions,).

    Args:
        pull: of the force at the pose (6,).
        found: rows by motions, by turn by reach and shift (contacts, 6), the motions (6, motions), and the pull.
    """
    contacts, i, on_part, kept, _, steps = trial
    rows, all_rows, tangents, motion_pull = found
    rows_at(pose, contacts, i, on_part, reach, all_rows)
    tangents_at(pose, kept, i, steps, reach, tangents)
    for j in range(tangents.shape[1]):
        motion_pull[j] = 0.0
        for r in range(6):
            motion_pull[j] += tangents[r, j] * pull[r]
        for k in range(all_rows.shape[0]):
            rows[k, j] = 0.0
            for r in range(6):
                rows[k, j] += all_rows[k, r] * tangents[r, j]


@nested
def shifted(pose: Any, trial: Any, reach: float, motion: Any, tangents: Any, step: Any) -> Any:
    """Move a pose along its motions (motions,); the length of the step."""
    _, i, _, kept, _, _ = trial
    for r in range(6):
        step[r] = 0.0
        for j in range(tangents.shape[1]):
            step[r] += tangents[r, j] * motion[j]
    length = stepped(pose, step, reach)
    restored(pose, kept, i, reach, step)
    return length
