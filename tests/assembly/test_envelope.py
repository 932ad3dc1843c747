"""Limits of size that bound the form: zones that the form narrows, fits that see it, standards, refusals."""

import re
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import Assembled, assembled
from numpy.typing import NDArray
from scipy.stats import kstest

from tol3d.assembly.zones import Bonus, Envelope, EnvelopedForm, SizedBy, Widened, catalogue, uniform_in
from tol3d.errors import SceneError
from tol3d.statistics.distributions import TruncatedNormal, Uniform
from tol3d.study.effects.extremes import ends_together
from tol3d.study.effects.first_order import first_orders
from tol3d.study.effects.worst_cases import worst_cases
from tol3d.study.system.draw import Scalar
from tol3d.study.system.plain import PlainContributor
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]

COUNT = 4000
T0, FORM, SIZE = 0.1, 0.04, 0.06  # mm; sizes from nominal to 0.06 mm above or below

FIT = """scene: a pin in its hole
ENVELOPE
parts:
  plate:
    kind: solid
    features:
      top: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1], extent: [60 mm, 60 mm]}
      hole: {kind: cylinder, at: [0 mm, 0 mm, -10 mm], axis: [0, 0, 1], length: 20 mm, diameter: 10.02 mm, hole: true}
      mark: {kind: point, at: [0 mm, 0 mm, 0 mm]}
  shaft:
    kind: solid
    features:
      face: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [60 mm, 60 mm]}
      pin: {kind: cylinder, at: [0 mm, 0 mm, -10 mm], axis: [0, 0, 1], length: 20 mm, diameter: 10 mm}
      tip: {kind: point, at: [0 mm, 0 mm, 0 mm]}
tolerances:
  hole size: {kind: size, of: plate.hole, distribution: {kind: uniform, lower: 0 mm, upper: 0.06 mm}}
  pin size: {kind: size, of: shaft.pin, PRINCIPLEdistribution: {kind: uniform, lower: -0.06 mm, upper: 0 mm}}
  place: {kind: position, of: plate.hole, zone: {diameter: 0.1 mm}, datums: [top], law: {kind: uniform}MODIFIER}
  hole form: {kind: straightness, of: plate.hole, zone: {diameter: 0.04 mm}}
  pin form: {kind: straightness, of: shaft.pin, zone: {diameter: 0.04 mm}, law: {kind: LAW}}
moves:
  bench: {kind: fix, part: plate}
  in:
    kind: pin_and_hole
    part: shaft
    relations: [{kind: coincident, from: shaft.face, to: plate.top}]
    pairs: [{from: shaft.pin, to: plate.hole}]
    float: {kind: toward, along: [1, 0, 0], at: shaft.tip}
measures:
  off: {kind: inspected_position, of: plate.hole, datums: [top]}
  aside: {kind: gap, from: plate.mark, to: shaft.tip, along: [1, 0, 0]}
  slack: {kind: slack, of: in}
  hole diameter: {kind: inspected_size, of: plate.hole}
  pin diameter: {kind: inspected_size, of: shaft.pin}
study: {trials: 500, seed: 1}
"""
UPRIGHT = "  upright: {kind: perpendicularity, of: plate.hole, zone: {diameter: 1 nm}, datums: [top]}\n"


def fit(envelope: str = "envelope: true\n", principle: str = "", law: str = "uniform", modifier: str = "") -> str:
    text = FIT.replace("ENVELOPE\n", envelope).replace("PRINCIPLE", principle).replace("LAW", law)
    text = text.replace("MODIFIER", f", modifier: {modifier}" if modifier else "")
    return text.replace(
        "moves:\n", f"{UPRIGHT}moves:\n", 1
    )  # the hole does not lean, so that clearances are its size's


def columns(made: Assembled, count: int) -> dict[str, Array]:
    deviations = drawn(made.simulation, 0, count).deviations
    return {own.name: deviations[:, columns] for own, columns in made.slices}


@pytest.mark.parametrize("modifier", ["", "mmc", "lmc"])
def test_a_zone_loses_what_form_the_size_of_the_trial_leaves(modifier: str, tmp_path: Path) -> None:
    """A hole keeps t - min(f, size - MMC) and its bonus, reached and never left; without an envelope t - f."""
    for envelope in ("envelope: true\n", ""):
        found = assembled(fit(envelope, modifier=modifier), tmp_path).drawn(COUNT, "analytic")
        size = found["hole diameter"] - 10.02
        bonus = {"": 0.0 * size, "mmc": size, "lmc": SIZE - size}[modifier]
        room = T0 + bonus - (np.minimum(size, FORM) if envelope else FORM)
        assert (found["off"] <= room + 2e-9).all()
        assert (found["off"] / room).max() > 0.999
        # the middle of an upright axis is uniform in its disc, whatever the size
        assert kstest((found["off"] / room) ** 2, "uniform").pvalue > 1e-3


@pytest.mark.parametrize("law", ["uniform", "normal"])
@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_a_fit_sees_size_and_form_and_never_beyond_the_maximum_material_size(
    method: str, law: str, tmp_path: Path
) -> None:
    """The pin's mating size by hand: its size and a share of min(f, MMC - size), from the contributors alone.

    The hole leans by half a nanometre at most.
    """
    made = assembled(fit(law=law), tmp_path)
    count = 2000
    found, drawn_ = made.drawn(count, method), columns(made, count)
    form, size = drawn_["pin form"][:, 0], drawn_["pin size"][:, 0]
    clearance = (0.02 + drawn_["hole size"][:, 0] - size - form) / 2
    assert found["slack"] == pytest.approx(clearance, abs=6e-7)
    assert found["aside"] == pytest.approx(drawn_["place"].mean(axis=1) * 0 + clearance + _aside(drawn_), abs=6e-7)
    assert (size + form <= 1e-15).all()
    share = form / np.minimum(FORM, -size)
    expected = Uniform(0.0, 1.0) if law == "uniform" else TruncatedNormal(0.0, 1 / 3, 0.0, 1.0)
    assert kstest(share, expected.cdf).pvalue > 1e-3
    assert abs(np.corrcoef(share, size)[0, 1]) < 4 / np.sqrt(count)


def _aside(drawn_: dict[str, Array]) -> Array:
    """The middle of the hole's axis, along x, at the face, for it does not lean."""
    return np.asarray(0.5 * (drawn_["place"][:, 0] + drawn_["place"][:, 2]))


@pytest.mark.parametrize(
    ("envelope", "principle", "bound"),
    [("", "", False), ("", "envelope: true, ", True), ("envelope: true\n", "envelope: false, ", False)],
)
def test_a_size_says_otherwise_than_the_scene(envelope: str, principle: str, bound: bool, tmp_path: Path) -> None:
    drawn_ = columns(assembled(fit(envelope, principle), tmp_path), COUNT)
    beyond = (drawn_["pin size"] + drawn_["pin form"]).max()
    assert beyond <= 1e-15 if bound else 0.035 < beyond <= FORM
    assert drawn_["pin form"].max() > 0.99 * FORM


def sized(law: Uniform, form: float) -> SizedBy:
    envelope = Envelope(0.0, SIZE, inner=True, form=form)
    return SizedBy("size", law, Bonus(0.0, SIZE, grows=True, of_zone=False, envelope=envelope))


@pytest.mark.parametrize("form", [0.02, 0.04, 0.09])
def test_closed_moments_are_those_of_direct_draws(form: float) -> None:
    """A zone whose form the size bounds, and the form in a fit, drawn by hand: sizes, then what they leave."""
    rng, count = np.random.default_rng(3), 400_000
    size = sized(Uniform(-0.01, SIZE), form)  # sizes beyond the limit too: no form is left
    sizes = rng.uniform(-0.01, SIZE, count)
    most = np.minimum(form, np.maximum(sizes, 0.0))
    share = rng.uniform(size=count)
    draw = EnvelopedForm(Uniform(0.0, 1.0), "uniform", size)
    assert draw.distribution.mean == pytest.approx((share * most).mean(), abs=4 * (share * most).std() / np.sqrt(count))
    assert draw.sigma == pytest.approx((share * most).std(), rel=5e-3)
    zone = catalogue.axis_section(T0, form)
    widened = Widened(zone, uniform_in(zone), size)
    radius = 0.5 * (T0 - most) * np.sqrt(rng.uniform(size=count))
    assert widened.sigma**2 == pytest.approx(0.5 * (radius**2).mean(), rel=5e-3)
    assert widened.distribution.high == pytest.approx(0.5 * T0)


@pytest.mark.parametrize(("per_form", "per_size"), [(-1.0, 1.0), (1.0, -1.0), (1.0, -0.5), (0.7, 1.0), (-0.2, -1.0)])
def test_the_worst_of_form_and_size_is_the_support_of_both(per_form: float, per_size: float) -> None:
    """Against a dense grid of sizes and shares, and as worst cases find it."""
    law = Uniform(0.0, SIZE)
    draw = EnvelopedForm(Uniform(0.0, 1.0), "uniform", sized(law, FORM))
    grid = np.linspace(0.0, SIZE, 6001)
    most = np.minimum(FORM, grid)
    brute = max((per_size * grid + per_form * share * most).max() for share in (0.0, 0.5, 1.0))
    assert draw.support(per_form, per_size) == pytest.approx(brute, abs=1e-12)
    both = [PlainContributor("form", "straightness", draw), PlainContributor("size", "size", Scalar(law))]
    slopes = {"form": np.array([per_form]), "size": np.array([per_size])}
    ends = ends_together(both, slopes, dict.fromkeys(slopes, False))
    assert sum(float(slopes[name] @ own[1]) for name, own in ends.items()) == pytest.approx(brute, abs=1e-9)


@pytest.mark.parametrize(("modifier", "wide"), [("", T0), ("mmc", T0 + SIZE - FORM), ("lmc", T0 + SIZE)])
def test_a_zone_is_widest_at_the_size_that_leaves_most(modifier: str, wide: float, tmp_path: Path) -> None:
    made = assembled(fit(modifier=modifier), tmp_path)
    draw = next(own.draw for own, _ in made.slices if own.name == "place")
    assert isinstance(draw, Widened)
    assert draw.support(np.array([0.5, 0.0, 0.5, 0.0])) == pytest.approx(0.5 * wide)
    assert draw.size.bonus.support(draw.confined, np.array([1.0, 0, 1.0, 0]), draw.size.law) == pytest.approx(wide)


def test_least_and_largest_clearance_are_those_of_the_envelope(tmp_path: Path) -> None:
    """A pin of its maximum material size, however bent, in the smallest hole; its least size in the largest one."""
    made = assembled(fit(), tmp_path)
    measure = next(own for own in made.system.measures if own.name == "slack")
    assert made.system.closed_form(measure) is None  # form and size go together
    assert first_orders(made.simulation, None, [measure])["slack"]["analytic"].ends == pytest.approx((10, 70), abs=1e-3)


@pytest.mark.parametrize(
    ("words", "form", "least"),
    [
        ("envelope: true", "diameter: 40 um", 10.0),  # at its maximum material size it may not bend
        ("standard: asme", "diameter: 40 um", -10.0),  # a straightness of the axis releases Rule #1
        ("standard: asme\nenvelope: true", "diameter: 40 um", -10.0),
        ("standard: asme", "width: 40 um", 10.0),  # lines of the surface do not
        ("standard: asme\nenvelope: false", "width: 40 um", -10.0),  # all sizes with an I in a circle
        ("standard: iso", "width: 40 um", -10.0),
    ],
)
def test_the_standard_says_which_worst_build_lies_within_the_tolerances(
    words: str, form: str, least: float, tmp_path: Path
) -> None:
    """Least clearance of a hole of 10.02 and a pin of 10 mm, upright: half of 20 um, or of 20 - 40 um."""
    of_the_pin = "kind: straightness, of: shaft.pin, zone:"
    text = fit(f"{words}\n").replace(f"{of_the_pin} {{diameter: 0.04 mm}}", f"{of_the_pin} {{{form}}}")
    made = assembled(text, tmp_path)
    measure = next(own for own in made.system.measures if own.name == "slack")
    found = worst_cases(made.simulation, None, [measure])["slack"]["analytic"]
    assert found is not None
    assert found.low is not None
    assert found.low.value == pytest.approx(least, abs=2e-3)  # it leans by half a nanometre
    deviations = {own.name: 1e3 * found.low.deviations[columns] for own, columns in made.slices}
    most = min(40.0, -deviations["pin size"][0]) if least > 0.0 else 40.0
    assert 0.0 <= deviations["pin form"][0] <= most + 1e-9


def test_a_size_keeps_its_envelope_whatever_the_standard(tmp_path: Path) -> None:
    drawn_ = columns(assembled(fit("standard: asme\n", "envelope: true, "), tmp_path), COUNT)
    assert (drawn_["pin size"] + drawn_["pin form"]).max() <= 1e-15


@pytest.mark.parametrize(
    ("form", "around", "warned"),
    [
        ("straightness, of: plate.hole, zone: {diameter: 30 um}", "{diameter: 10 um}", "30 um"),
        ("straightness, of: plate.hole, zone: {width: 11 um}", "{diameter: 10 um}", "11 um"),
        ("straightness, of: plate.hole, zone: {diameter: 10 um}", "{diameter: 10 um}", ""),
        ("straightness, of: plate.hole, zone: {diameter: 30 um}", "{width: 10 um, along: [1, 0, 0]}", ""),
        ("cylindricity, of: plate.hole, zone: {width: 30 um}", "{diameter: 10 um}", ""),  # it may be lobed
    ],
)
def test_a_form_wider_than_its_orientation_is_warned_of(form: str, around: str, warned: str, tmp_path: Path) -> None:
    text = fit().replace("kind: straightness, of: plate.hole, zone: {diameter: 0.04 mm}", f"kind: {form}")
    text = text.replace(UPRIGHT, UPRIGHT.replace("{diameter: 1 nm}", around))
    (found,) = assembled(text, tmp_path).simulation.implausible or ("",)
    place = "tolerances.hole form.zone: expected at most the 10 um of 'upright'"
    assert re.match(f"{place}, .* got {warned}; " if warned else "$", found)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("law: {kind: LAW}", "law: {kind: process, distribution: {kind: constant, value: 0 mm}}", "uniform or normal"),
        (
            "moves:\n",
            "  pin round: {kind: roundness, of: shaft.pin, zone: {width: 0.01 mm}, law: {kind: uniform}}\nmoves:\n",
            "they do not add up in a fit",
        ),
    ],
)
def test_what_is_refused(old: str, new: str, words: str, tmp_path: Path) -> None:
    text = FIT.replace(old, new, 1).replace("ENVELOPE\n", "envelope: true\n").replace("PRINCIPLE", "")
    text = text.replace("LAW", "uniform").replace("MODIFIER", "")
    with pytest.raises(SceneError, match=words):
        assembled(text, tmp_path)


def test_a_scene_without_sizes_has_no_envelope(tmp_path: Path) -> None:
    lines = [line for line in fit().splitlines(keepends=True) if "size:" not in line and "form:" not in line]
    text = "".join(lines).replace("  hole diameter", "  # ").replace("  pin diameter", "  # ")
    with pytest.raises(SceneError, match="expected a size tolerance, whose limits bound a form"):
        assembled(text, tmp_path)
