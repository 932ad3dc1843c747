"""Play of links that are no gear meshes in some trials, by either method's law."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from tol3d.gearing.links import FreeTurn, LinkTrials, StatedLink
from tol3d.gearing.model import Measure, Model
from tol3d.gearing.model.model import Contributor
from tol3d.numerics.arrays import Array
from tol3d.study.system.trials import Trials

DEAR: Final = 4
"""Contacts of a link from which it pays to look for trials that are alike for it."""

LinkLaw = Callable[[StatedLink, LinkTrials], FreeTurn]
"""The free turn of a link's driven shaft."""


@dataclass
class Remembered:
    """A law that computes the free turns of a link in the same trials once, for all measures."""

    law: LinkLaw
    known: dict[tuple[str, tuple[int, ...], bytes], FreeTurn] = field(default_factory=dict)

    def __call__(self, link: StatedLink, seen: LinkTrials) -> FreeTurn:
        """See LinkLaw; all calls are for the same trials."""
        key = link.name, seen.angles.shape, seen.angles.tobytes()
        if key not in self.known:
            self.known[key] = _each_once(self.law, link, seen) if link.contacts >= DEAR else self.law(link, seen)
        return self.known[key]


def _each_once(law: LinkLaw, link: StatedLink, seen: LinkTrials) -> FreeTurn:
    """Free turns, solved once for trials that are alike for the link, such as if something else deviates."""
    rows = np.ascontiguousarray(np.concatenate([seen.angles, *seen.deviations.values()], axis=1))
    first: dict[bytes, int] = {}
    places = np.array([first.setdefault(row.tobytes(), len(first)) for row in rows], dtype=np.intp)
    if len(first) == len(rows):
        return law(link, seen)
    found = law(link, seen.rows(np.unique(places, return_index=True)[1]))
    middle = None if found.middle is None else found.middle[places]
    return FreeTurn(found.play[places], middle, None if found.jams is None else found.jams[places])


def as_built(link: StatedLink, seen: LinkTrials) -> FreeTurn:
    """That of the geometric method."""
    return link.exact(seen)


def by_theory(link: StatedLink, seen: LinkTrials) -> FreeTurn:
    """That of the analytic method."""
    return link.analytic(seen)


def link_contributors(model: Model, link: str) -> tuple[Contributor, ...]:
    """The contributors whose deviations are a link's."""
    return tuple(contributor for contributor in model.contributors if contributor.effect.acts_on(link))


def link_trials(model: Model, measure: Measure, link: StatedLink, trials: Trials) -> LinkTrials:
    """Trials as seen by a link where a measure is read."""
    own = link_contributors(model, link.name)
    deviations = {each.name: trials.deviations[:, model.component_slices[each.name]] for each in own}
    return LinkTrials(own, deviations, _angles(model, measure, link, trials))


def _angles(model: Model, measure: Measure, link: StatedLink, trials: Trials) -> Array:
    if link.turns is None or not model.layout.mesh_turn[link.name].rate:
        return np.zeros((len(trials), measure.positions.in_a_trial))
    fixed = model.driver_angles(measure, link.name)
    if fixed is None:
        return trials.positions[link.name][:, None]
    return np.broadcast_to(np.array(fixed), (len(trials), len(fixed)))
