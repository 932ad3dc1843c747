"""Builds of a scene for the page's 3D view: a GLB of the parts, and where they stand, without a run."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

import numpy as np

from tol3d.errors import Tol3dError
from tol3d.numerics.arrays import Array
from tol3d.report import ViewModel, display_build
from tol3d.report.presenter import Display
from tol3d.simulate import Replay, replayed
from tol3d.study import Simulation
from tol3d.study.system import Trials, nominal_build

NOMINAL: Final = "nominal"
FACTORS: Final = (1.0, 10.0, 100.0)
"""Magnifications of deviations; a build shows those that it allows."""


def build_view(
    simulation: Simulation,
    rows: Mapping[str, tuple[Array, Mapping[str, Array] | None]],
    *,
    factors: Sequence[float] = FACTORS,
    world: str = "",
) -> tuple[bytes, dict[str, Any]]:
    """The nominal build and others, as `viewer.js` shows them.

    Args:
        simulation: of the scene.
        rows: deviations (components,) [mm, rad, K] of each further build by its name, and its positions, a number each
            by name; None: at rest.
        factors: of the deviations, the least first; those with which a build cannot be shown are left out.
        world: the one that is shown; "" for that with the most parts.

    Returns:
        a GLB of every mesh once [mm]; and for JSON what `ViewModel.told` tells, the names of all `worlds`, and
        `refused`: by the names of builds of `rows` that cannot be shown, why.

    Raises:
        Tol3dError: the nominal build cannot be shown, or there is no such world.
    """
    model, refused = ViewModel(wanted=world), dict[str, str]()
    rest = nominal_build(simulation.system)
    nominal = display_build(replayed(simulation, rest), NOMINAL)
    model.add(NOMINAL, [(1.0, nominal, _words(nominal))])
    for name, (deviations, positions) in rows.items():
        standing = rest.positions if positions is None else {key: np.atleast_1d(own) for key, own in positions.items()}
        trials = Trials(np.atleast_2d(deviations), standing)
        try:
            model.add(name, _displays(replayed(simulation, trials), name, factors))
        except Tol3dError as error:
            refused[name] = str(error)
    worlds = [own.name for own in nominal.worlds if own.bodies]
    return model.glb(), {**model.told(), "worlds": worlds, "refused": refused}


def _displays(build: Replay, name: str, factors: Sequence[float]) -> Iterator[tuple[float, Display, str]]:
    """A build by every factor with which it can be shown.

    Raises:
        Tol3dError: it cannot be by the first.
    """
    for factor in factors:
        try:
            display = display_build(build, name, magnify=factor)
        except Tol3dError:
            if factor == factors[0]:
                raise
            return
        yield factor, display, _words(display)


def _words(display: Display) -> str:
    return "; ".join((display.label, *display.notes))
