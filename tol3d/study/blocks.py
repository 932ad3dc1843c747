"""Blocks of a study's trials, whose statistics are folded together and that are written as one file each."""

import math
from typing import Final

from tol3d.execution.folding import Plan
from tol3d.study.simulation import Simulation
from tol3d.system.stated import component_count

BLOCK_TRIALS: Final = 65_536
AUTO_BLOCK_TRIALS: Final = 16_384  # of a study that may stop after any block
AUTO_SLOW_BLOCK_TRIALS: Final = 2048  # the same where a trial is slow: a second of them
BLOCK_VALUES: Final = 2**22  # values of a curve, or of all draws, in one block: 32 MB


def block_trials(simulation: Simulation) -> int:
    """Trials of a canonical block: fewer where curves keep many positions, a trial has many draws, or it takes long."""
    curves = (measure for measure in simulation.system.measures if measure.take == "curve")
    kept = max((measure.positions.in_a_trial for measure in curves), default=1)
    values = max(kept, component_count(simulation.system), 1)
    return max(min(_most(simulation), _tidy(BLOCK_VALUES / values), *_in_time(simulation)), 1)


def _in_time(simulation: Simulation) -> list[int]:
    most = simulation.method.block_contacts
    return [] if most is None else [_tidy(most / max(contacts_of(simulation), 1))]


def _tidy(trials: float) -> int:
    return 1 << max(int(math.log2(trials)), 0)


def _most(simulation: Simulation) -> int:
    if not simulation.study.until:
        return BLOCK_TRIALS
    return AUTO_BLOCK_TRIALS if simulation.method.threads else AUTO_SLOW_BLOCK_TRIALS


def contacts_of(simulation: Simulation) -> int:
    """Number of contacts that one trial takes."""
    return simulation.system.cost(simulation.system.measures)


def plan_of(simulation: Simulation) -> Plan:
    """Largest number of trials, and their division into blocks."""
    return Plan(simulation.study.trials, block_trials(simulation), contacts_of(simulation))
