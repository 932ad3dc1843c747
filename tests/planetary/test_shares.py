"""Shares of the variance of planetary sets: parts that add up to the measure, and what goes away with a contributor."""

import dataclasses

import numpy as np
import pytest
from numpy.typing import NDArray
from places import SCENES

from tol3d import Overrides, load_scene
from tol3d.gearing.planetary.from_scene import planetary_system
from tol3d.gearing.planetary.system import PlanetarySystem
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.method import ANALYTIC_METHOD
from tol3d.study.system.regressors import regressor_count
from tol3d.study.system.stated import component_slices
from tol3d.study.system.trials import Trials
from tol3d.study.trials.columns import columns_of
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.overrides import simulation_of

Array = NDArray[np.float64]


class Sample:
    """Trials of a shipped scene, and the first contributors' parts in one of its measures [arcmin]."""

    def __init__(self, scene: str, measure: str, trials: int) -> None:
        simulation = simulation_of(load_scene(SCENES / f"{scene}.yaml"), Overrides(trials=trials))
        self.system: PlanetarySystem = planetary_system(load_scene(SCENES / f"{scene}.yaml"))
        self.own = self.system.read[measure]
        self.measured(drawn(simulation, 0, trials))

    def measured(self, trials: Trials) -> None:
        self.trials, self.values, count = trials, self.of(trials), len(trials)
        self.rows = {own.name: np.full((regressor_count(own), count), np.nan) for own in self.system.contributors}
        columns = columns_of(self.system, None, trials, (self.own,))
        self.system.regress(self.own, self.system.contributors, columns, self.rows)

    def of(self, trials: Trials) -> Array:
        found = columns_of(self.system, None, trials, (self.own,))
        return np.asarray(found[f"{ANALYTIC_METHOD}:{self.own.name}"])

    def share(self, contributor: str) -> float:
        both = np.cov(self.rows[contributor][0], self.values)
        return float(both[0, 1] / both[1, 1])

    def frozen(self, contributor: Contributor) -> Array:
        """Values with that contributor at its mean in every trial."""
        slots = component_slices(self.system)[contributor.name]
        deviations = self.trials.deviations.copy()
        deviations[:, slots] = contributor.draw.mean(turning=self.own.positions.over == "random")
        return self.of(dataclasses.replace(self.trials, deviations=deviations))


@pytest.mark.parametrize(
    ("scene", "measure"),
    [
        ("reducer_3k", "lost motion"),
        ("reducer_3k", "lost motion of the input"),
        ("reducer_3k", "transmission error"),
        ("reducer_3k", "sine of the output"),
        ("reducer_3k_flexible", "lost motion"),
        ("reducer_3k_flexible", "transmission error"),
    ],
)
def test_the_parts_of_all_contributors_add_up_to_the_measure(scene: str, measure: str) -> None:
    """Gaps are alike at the mean build, so that which contacts are met changes nothing but the parts."""
    own = Sample(scene, measure, 40)
    left = own.values - sum(rows[0] for rows in own.rows.values())
    np.testing.assert_allclose(left, left[0], rtol=0, atol=1e-9)
    assert all((rows[1:] == 0.0).all() for rows in own.rows.values())


@pytest.mark.slow
@pytest.mark.parametrize(("scene", "within"), [("reducer_3k", 0.02), ("reducer_3k_flexible", 0.035)])
def test_a_contributor_that_does_not_vary_takes_its_share_of_the_variance_along(scene: str, within: float) -> None:
    """Frozen at its mean, one by one: what is left of the variance says the same, and shares no code with the parts.

    20 000 trials: 1 sigma of a difference of variances of common trials is below 0.005 there. Parts of planets that are
    never met change with what is frozen, the more the larger they are: the rest of the bound.
    """
    own = Sample(scene, "lost motion", 20_000)
    variance = own.values.var()
    gone = {each.name: 1 - own.frozen(each).var() / variance for each in own.system.contributors}
    shares = {name: own.share(name) for name in gone}
    assert sum(shares.values()) == pytest.approx(1.0, abs=1e-3)
    assert shares == pytest.approx(gone, abs=within)
    assert sum(gone.values()) == pytest.approx(1.0, abs=0.1)
    assert sorted(shares, key=shares.__getitem__)[-2:] == sorted(gone, key=gone.__getitem__)[-2:]


def test_what_one_spring_leaves_has_the_parts_of_its_closed_form() -> None:
    """With gaps alike in all planets it is 2 |D|/rR2, D = c_c - k c_b - (1 - k)(c_a + c_b)/2.

    So each part is that of a clearance in D, with the sign of D. Clearances c are half the thinning of the central gear
    along the normals; what planets thin is alike in all of them, and D is 0 at the means.
    """
    own = Sample("reducer_3k_flexible", "lost motion", 200)
    slices = component_slices(own.system)
    deviations = own.trials.deviations.copy()
    for each in own.system.contributors:
        if each.name not in ("sun thinning", "ring 1 thinning", "ring 2 thinning"):
            deviations[:, slices[each.name]] = each.draw.mean(turning=True)
    own.measured(dataclasses.replace(own.trials, deviations=deviations))
    kappa, radius = 24 / 27, 38.0 * np.cos(np.radians(20))
    weights = {"sun thinning": -(1 - kappa) / 2, "ring 1 thinning": -(1 + kappa) / 2, "ring 2 thinning": 1.0}
    mean = -0.035
    parts = {
        name: -weight * (deviations[:, slices[name]][:, 0] - mean) / 2 / radius * 2 * 60 * 180 / np.pi
        for name, weight in weights.items()
    }
    signed = sum(parts.values())
    np.testing.assert_allclose(own.values, np.abs(signed), rtol=0, atol=1e-6)
    clear = np.abs(signed) > 1e-4
    for name, part in parts.items():
        np.testing.assert_allclose(own.rows[name][0][clear], (part * np.sign(signed))[clear], rtol=0, atol=1e-6)
