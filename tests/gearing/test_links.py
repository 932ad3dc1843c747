"""Links from elsewhere in trains of gears: a coupling, a belt, planets on a carrier.

Thin teeth leave (s1 + s2) cos(20 deg) of normal gap, which a driven gear of pitch radius r turns through by itself in
(s1 + s2) / r. All else is written down here by the toys' laws, trial by trial. What a train leaves free is a linear
programme: shafts turn by small angles, each link lets its driven shaft differ from what Willis asks for by its play,
one shaft is held, and another is turned to its ends.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from gear_trials import drawn_trials
from numpy.typing import NDArray
from scipy.optimize import linprog
from toys.drives import DRIVES
from toys.drives.belt import Belt
from toys.parabola import PARABOLA
from toys.registered import TOYS, known

from tol3d import InputError, Overrides, Run, SceneError, load_scene, replay, run_scene
from tol3d.gearing.engines.gaps import exact_engine
from tol3d.gearing.links import Reducer
from tol3d.gearing.model import model_from_scene
from tol3d.gearing.model.layout import layout_of
from tol3d.gearing.model.links import Link, freed_turn, load_path_between, turns_of
from tol3d.gearing.presenting.whole_trains import whole_trains
from tol3d.gearing.shown.display import seated_build
from tol3d.gearing.slopes.sensitivity import sensitivities
from tol3d.study.execution.pools import Execution
from tol3d.study.results.replaying import build_of
from tol3d.study.results.versions import installed_versions
from tol3d.study.system.trials import Trials

Array = NDArray[np.float64]

ARCMIN = 10800 / math.pi  # in a radian
UM = 1e-3  # mm
AGREES = 1e-8 * ARCMIN  # arcmin; where the exact engine's steps end, 1e-8 mm at arms of some 20 mm, a few times
SAME = 1e-10  # arcmin; rounding
SIX_SIGMA = 6.0  # a natural tolerance is six sigma wide
SURE = 5.0  # standard errors

SCENES = {name: TOYS / "drives" / f"{name}.yaml" for name in ("series", "parallel", "wolfrom")}


@pytest.fixture(scope="module", autouse=True)
def drives() -> Iterator[None]:
    with known(DRIVES):
        yield


@pytest.fixture(scope="module")
def runs(drives: None, tmp_path_factory: pytest.TempPathFactory) -> Mapping[str, Run]:
    folder = tmp_path_factory.mktemp("drives")
    return {name: run_scene(scene, out=folder / name) for name, scene in SCENES.items()}


def rewritten(folder: Path, name: str, **words: str) -> Path:
    """A scene with lines written otherwise, by their first word, spaces as _; "" takes a line out."""
    lines = []
    for line in SCENES[name].read_text("utf-8").splitlines():
        key = line.split(":")[0].strip().replace(" ", "_")
        if key in words and line.startswith("  "):
            if words[key]:
                lines.append(f"  {key.replace('_', ' ')}: {words[key]}")
        else:
            lines.append(line)
    path = folder / f"{name}.yaml"
    path.write_text("\n".join(lines) + "\n", "utf-8")
    return path


def free(angle: Array, x: Array, y: Array, sag: Array, radius: float) -> tuple[Array, Array]:
    """Play of a belt and its middle [arcmin] at an angle [rad]; lengths in um."""
    play = (sag + x * np.cos(angle) - y * np.sin(angle)) * UM / radius
    return play * ARCMIN, (x * np.sin(angle) + y * np.cos(angle)) * UM / (2 * radius) * ARCMIN


def of_belt(columns: Mapping[str, Array], radius: float) -> tuple[Array, Array]:
    angle = np.radians(columns["position:belt [deg]"])
    return free(angle, columns["pulley.x [um]"], columns["pulley.y [um]"], columns["sag [um]"], radius)


def of_teeth(columns: Mapping[str, Array], radius: float, *gears: str) -> Array:
    """Play [arcmin] of a driven gear by what its teeth and its driver's lack."""
    lacking = sum(-columns[f"{gear} thickness [um]"] for gear in gears)
    return np.asarray(lacking * UM / radius * ARCMIN)


def of_jaws(columns: Mapping[str, Array], slack: float, method: str) -> Array:
    """Play [arcmin] of jaws at 12 mm; the slack in um."""
    opening = (slack + columns["wear [um]"]) * UM / 12.0
    return np.asarray((opening if method == "analytic" else 2 * np.arcsin(opening / 2)) * ARCMIN)


# in series -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["analytic", "geometric"])
def test_in_series_the_plays_add_up_by_the_ratios(runs: Mapping[str, Run], method: str) -> None:
    """24:56 and then 20:30 after the gearbox; 20:30 after the pair."""
    columns = runs["series"].columns()
    belt, _ = of_belt(columns, 20.0)
    pair = of_teeth(columns, 42.0, "sun", "wheel")
    by_belt = 20 / 30
    wanted = columns["gearbox play [arcmin]"] * (24 / 56) * by_belt + pair * by_belt + belt
    wanted = wanted + of_jaws(columns, 600.0, method)
    assert np.abs(columns[f"{method}:lost motion"] - wanted).max() < AGREES
    assert belt.std() > 1.0  # else the position would not matter


def test_each_link_has_a_term_of_its_own(runs: Mapping[str, Run]) -> None:
    columns, found = runs["series"].columns(), runs["series"].summary
    stages = found["trains"]["train"]["stages"]
    assert [stage["kind"] for stage in stages] == ["reducer", "mesh", "belt", "jaw_coupling"]
    assert [stage["ratio"] for stage in stages] == pytest.approx([5, -56 / 24, 30 / 20, 1], rel=1e-15)
    belt = next(stage for stage in stages if stage["link"] == "belt")
    assert belt["methods"]["geometric"]["mean"] == pytest.approx(of_belt(columns, 20.0)[0].mean(), rel=1e-12)
    assert columns["geometric:lost motion:jaws [arcmin]"] == pytest.approx(of_jaws(columns, 600.0, "geometric"))


def test_of_a_law_that_depends_on_the_position_there_is_no_closed_form(runs: Mapping[str, Run]) -> None:
    assert "analytic_closed_form" not in runs["series"].summary["measures"]["lost motion"]
    assert "analytic_closed_form" in runs["wolfrom"].summary["measures"]["lost motion"]


def test_methods_that_differ_are_explained_by_what_differs(runs: Mapping[str, Run]) -> None:
    """2 asin(s / 2r) - s / r = (s / r)^3 / 24 + ...; s / r up to 1/12."""
    agreement = runs["series"].summary["measures"]["lost motion"]["agreement"]
    most = (2 * math.asin(1 / 24) - 1 / 12) * ARCMIN
    assert 0.5 * most < agreement["max_abs_difference"] < most
    assert agreement["explanation"]["second_order_of"] == ["wear"]
    assert not agreement["explanation"]["faults"]


# in parallel ---------------------------------------------------------------------------------------------------------


def beside(columns: Mapping[str, Array], method: str, clocking: Array) -> Array:
    """Joint play of belt and gears, and of the jaws after them [arcmin]."""
    belt, middle = of_belt(columns, 20.0)
    gears = of_teeth(columns, 20.0, "first", "second", "third", "fourth")  # 20:40:20 teeth, twice 20 mm over 40 mm
    shift = -clocking  # a gear that sits ahead leaves its shaft behind
    low = np.maximum(middle - belt / 2, shift - gears / 2)
    high = np.minimum(middle + belt / 2, shift + gears / 2)
    return np.asarray(high - low + of_jaws(columns, 60.0, method))


@pytest.mark.parametrize("method", ["analytic", "geometric"])
def test_in_parallel_the_plays_intersect(runs: Mapping[str, Run], method: str) -> None:
    columns = runs["parallel"].columns()
    wanted = beside(columns, method, columns["clocking [arcmin]"])
    assert np.abs(columns[f"{method}:lost motion"] - wanted).max() < AGREES
    belt, middle = of_belt(columns, 20.0)
    gears = of_teeth(columns, 20.0, "first", "second", "third", "fourth")
    alone = np.minimum(belt, gears) + of_jaws(columns, 60.0, method)
    assert (alone - wanted > 1.0).mean() > 0.2  # clocking and the belt's own middle matter
    assert 0.2 < (belt < gears).mean() < 0.8  # and either is the tighter one
    assert np.abs(middle).max() > 1.0


def test_links_bind_gears_where_their_plays_do_not_meet(tmp_path: Path) -> None:
    law = "{kind: clocking, of: fourth, distribution: {kind: normal, lower: -90 arcmin, upper: 90 arcmin}}"
    run = run_scene(rewritten(tmp_path, "parallel", clocking=law), out=tmp_path / "run")
    columns = run.columns()
    wanted = beside(columns, "geometric", columns["clocking [arcmin]"]) - of_jaws(columns, 60.0, "geometric")
    bound = columns["status:lost motion"] == "interferes"
    assert 0.1 < bound.mean() < 0.9
    assert np.array_equal(bound, wanted < 0.0)


def test_derivatives_are_those_of_the_law(runs: Mapping[str, Run]) -> None:
    """Central differences of the closed form; where one side differs from the other is a kink."""
    model = model_from_scene(load_scene(SCENES["parallel"]))
    trials = drawn_trials(model, 9, 0, 200)
    (measure,) = model.measures
    found = sensitivities(model, exact_engine(model), trials, measure)
    step, compared = 1e-6, 0  # mm, rad
    for name, own in model.component_slices.items():
        for index in range(own.start, own.stop):
            ends = [closed(model.component_slices, trials, index, sign * step) for sign in (1, 0, -1)]
            ahead, back = (ends[0] - ends[1]) / step, (ends[1] - ends[2]) / step
            smooth = np.abs(ahead - back) < 1e-3
            assert smooth.mean() > 0.99, name
            # of the jaws' arc the third derivative, s / r^4 / 4, times the step twice, and rounding of 1e-2 rad
            assert np.abs(found[:, index] - (ahead + back) / 2)[smooth].max() < 1e-7, name
            compared += int((np.abs(ahead) > 1e-3).sum())
    assert compared > 1000


def closed(slices: Mapping[str, slice], trials: Trials, index: int, step: float) -> Array:
    """Lost motion [rad] of the parallel scene by hand, one deviation moved."""
    deviations = trials.deviations.copy()
    deviations[:, index] += step
    columns = {"position:belt [deg]": np.degrees(trials.positions["belt"])}
    for name, own in slices.items():
        rows = deviations[:, own]
        unit, size = ("arcmin", 1 / ARCMIN) if name == "clocking" else ("um", UM)
        parts = ("",) if rows.shape[1] == 1 else (".x", ".y")
        columns |= {f"{name}{part} [{unit}]": rows[:, k] / size for k, part in enumerate(parts)}
    return beside(columns, "geometric", columns["clocking [arcmin]"]) / ARCMIN


# on a carrier --------------------------------------------------------------------------------------------------------

Play = tuple[float, float]
"""From where to where the driven shaft of a link may turn against the place that Willis asks for."""


def reach(links: Sequence[Link], plays: Mapping[str, Play], read: str, held: str) -> float:
    """Largest turn of a shaft while another one is held, by a linear programme."""
    shafts = list(dict.fromkeys(shaft for link in links for shaft in (link.driver, link.driven)))
    rows, bounds = [], []
    for link in links:
        row = np.zeros(len(shafts))
        row[shafts.index(link.driven)] += 1.0
        row[shafts.index(link.driver)] -= float(link.rate)
        if link.carrier is not None:
            row[shafts.index(link.carrier)] += float(link.rate) - 1.0
        low, high = plays[link.name]
        rows += [row, -row]
        bounds += [high, -low]
    costs = np.array([shaft == read for shaft in shafts], dtype=np.float64)
    within = [(0.0, 0.0) if shaft == held else (None, None) for shaft in shafts]
    least, most = (linprog(sign * costs, np.array(rows), np.array(bounds), bounds=within) for sign in (1, -1))
    assert (least.status, most.status) == (0, 0)
    return float(-most.fun - least.fun)


WOLFROM = (
    Link("fixed ring", "sun", "carrier", Fraction(12, 60)),
    Link("planets", "sun", "planet", Fraction(-12, 18), "carrier"),
    Link("second ring", "planet", "ring", Fraction(15, 45), "carrier"),
    Link("pair", "ring", "output", Fraction(-24, 56)),
)


@pytest.mark.parametrize(
    ("measure", "read", "held"), [("lost motion", "output", "sun"), ("with the carrier held", "ring", "carrier")]
)
def test_with_planets_lost_motion_is_what_a_programme_finds(
    runs: Mapping[str, Run], measure: str, read: str, held: str
) -> None:
    columns = runs["wolfrom"].columns()
    plays = {
        "fixed ring": columns["in the fixed ring [arcmin]"],
        "planets": columns["at the planet [mrad]"] * 1e-3 * ARCMIN,
        "second ring": columns["at the ring [mrad]"] * 1e-3 * ARCMIN,
        "pair": of_teeth(columns, 42.0, "pinion", "wheel"),
    }
    wanted = [
        reach(WOLFROM, {name: (-own[k] / 2, own[k] / 2) for name, own in plays.items()}, read, held) for k in range(60)
    ]
    for method in ("analytic", "geometric"):
        assert np.abs(columns[f"{method}:{measure}"][:60] - wanted).max() < AGREES


def test_a_ring_s_rate_follows_willis() -> None:
    """The carrier turns 12/60 with the sun; the second ring 1/45, Willis twice, and the output 24/56 of that, back."""
    turns = turns_of(WOLFROM)
    assert turns == {
        "sun": 1,
        "carrier": Fraction(1, 5),
        "planet": Fraction(-1, 3),  # 1/5 - 12/18 of 4/5
        "ring": Fraction(1, 45),
        "output": Fraction(-1, 105),
    }
    fixed_ring, planet, stepped, ring = 48, 18, 15, 45
    assert turns["ring"] == turns["carrier"] * (1 - Fraction(fixed_ring * stepped, planet * ring))  # VDI 2157


def test_the_closed_form_is_that_of_the_sum(runs: Mapping[str, Run]) -> None:
    """Weights by hand from the freed shafts: 24/56 of 11/9, 1/3 and 1, and the pair's own turn."""
    laws = {  # mean and sigma [arcmin], weight
        "fixed ring": (4.0, 4 / math.sqrt(12), 24 / 56 * 11 / 9),
        "planets": (10.0, 12 / SIX_SIGMA, 24 / 56 / 3),
        "second ring": (2.0, 2 / SIX_SIGMA, 24 / 56),
        "pair": (2 * 50 * UM / 42 * ARCMIN, math.sqrt(2) * 20 * UM / SIX_SIGMA / 42 * ARCMIN, 1.0),
    }
    found = runs["wolfrom"].summary["measures"]["lost motion"]["analytic_closed_form"]
    mean = sum(own * weight for own, _, weight in laws.values())
    sigma = math.hypot(*(own * weight for _, own, weight in laws.values()))
    assert found["mean"] == pytest.approx(mean, rel=1e-12)
    assert found["sigma"] == pytest.approx(sigma, rel=1e-12)
    sample = runs["wolfrom"].summary["measures"]["lost motion"]["geometric"]
    assert abs(sample["mean"] - mean) < SURE * sigma / math.sqrt(300)


@dataclass(frozen=True)
class Tree:
    """Shafts that one shaft turns, some of them carried round."""

    links: tuple[Link, ...]
    shafts: tuple[str, ...]


def random_tree(rng: np.random.Generator, count: int) -> Tree:
    """Each shaft is driven by an earlier one, against another earlier one or none; none stands still."""
    while True:
        links: list[Link] = []
        for k in range(1, count):
            driver, about = (int(place) for place in rng.integers(0, k, 2))
            rate = Fraction(int(rng.integers(1, 40)), int(rng.integers(1, 40))) * int(rng.choice((-1, 1)))
            carrier = f"s{about}" if about != driver and rng.random() < 0.6 else None
            links.append(Link(f"l{k}", f"s{driver}", f"s{k}", rate, carrier))
        if all(turns_of(links).values()):
            return Tree(tuple(links), tuple(f"s{k}" for k in range(count)))


@pytest.mark.parametrize("seed", range(12))
def test_of_any_tree_the_weights_are_those_of_a_programme(seed: int) -> None:
    rng = np.random.default_rng(seed)
    tree = random_tree(rng, int(rng.integers(3, 8)))
    first, last = (str(name) for name in rng.choice(tree.shafts, 2, replace=False))
    plays = {link.name: float(rng.uniform(0.5, 2.0)) for link in tree.links}
    ends = {name: (-play / 2, play / 2) for name, play in plays.items()}
    weights = {link.name: float(freed_turn(tree.links, link.driven, last, first)) for link in tree.links}
    total = sum(abs(weight) * plays[name] for name, weight in weights.items())
    # HiGHS is exact to 1e-9 of the bounds, which the weights carry
    assert total == pytest.approx(reach(tree.links, ends, last, first), rel=1e-6, abs=1e-6)
    path = load_path_between(tree.links, first, last)
    assert {element.name for element in path} == {name for name, weight in weights.items() if weight}


@pytest.mark.parametrize("seed", range(12))
def test_of_any_tree_the_turns_satisfy_every_link(seed: int) -> None:
    """One linear equation a link, solved together."""
    rng = np.random.default_rng(100 + seed)
    tree = random_tree(rng, int(rng.integers(3, 8)))
    rows = np.zeros((len(tree.shafts), len(tree.shafts)))
    rows[0, 0] = 1.0
    for row, link in zip(rows[1:], tree.links, strict=True):
        row[tree.shafts.index(link.driven)] += 1.0
        row[tree.shafts.index(link.driver)] -= float(link.rate)
        if link.carrier is not None:
            row[tree.shafts.index(link.carrier)] -= 1.0 - float(link.rate)
    solved = np.linalg.solve(rows, np.eye(len(tree.shafts))[0])
    turns = turns_of(tree.links)
    assert [float(turns[shaft]) for shaft in tree.shafts] == pytest.approx(solved.tolist(), rel=1e-9)


def belt(name: str, driver: str, driven: str, rate: Fraction, carrier: str | None = None) -> Belt:
    return Belt(name=name, driver=driver, driven=driven, rate=rate, carrier=carrier, radius=20.0, distance=50.0)


def test_positions_count_against_the_carrier() -> None:
    """The carrier turns by 1/5: against it the sun turns by 4/5, and a turn of its pulley takes 5/4 of the sun's."""
    ring = Reducer(name="ring", driver="sun", driven="carrier", rate=Fraction(1, 5))
    layout = layout_of((), (), (ring, belt("round", "sun", "planet", Fraction(1), "carrier")))
    assert layout.mesh_turn["round"].rate == Fraction(4, 5)
    assert layout.shaft_turn["planet"].rate == 1  # equal pulleys: it turns with the sun
    (drive,) = layout.drives
    assert drive.turns == Fraction(5, 4)
    both = layout_of(
        (), (), (ring, belt("round", "sun", "p", Fraction(1), "carrier"), belt("at", "sun", "q", Fraction(1)))
    )
    assert both.drives[0].turns == 5  # least common multiple of 5/4 and 1


@pytest.mark.parametrize("method", ["analytic", "geometric"])
def test_on_a_carrier_play_follows_the_angle_against_it(tmp_path: Path, method: str) -> None:
    """The sun at 100 deg, the carrier at 20: the pulley stands at 80 deg against it."""
    scene = rewritten(
        tmp_path,
        "wolfrom",
        planets="{kind: belt, driver: sun, driven: planet, carrier: carrier, teeth: [12, 18], radius: 18 mm, "
        "distance: 30 mm}",
        at_the_planet="{kind: belt_sag, of: planets, distribution: {kind: uniform, lower: 50 um, upper: 90 um}}",
        at_the_ring="{kind: pulley_offset, of: planets, distribution: {kind: rayleigh, scale: 9 um}}",
        train="{kind: train, driven: sun, output: planet}",
        from_the_carrier="",
        lost_motion="{kind: lost_motion, of: train, over: {at: 100 deg}}",
        with_the_carrier_held="",
    )
    columns = run_scene(scene, out=tmp_path / "run").columns()
    own, _ = free(
        np.full(300, math.radians(80)),
        columns["at the ring.x [um]"],
        columns["at the ring.y [um]"],
        columns["at the planet [um]"],
        18.0,
    )
    # the carrier's play c turns the planet by c (1 - 12/18) while the sun is held
    wanted = own + columns["in the fixed ring [arcmin]"] / 3
    assert np.abs(columns[f"{method}:lost motion"] - wanted).max() < SAME


@pytest.mark.slow
def test_a_shaft_on_a_carrier_is_shown_where_it_went(runs: Mapping[str, Run]) -> None:
    """About the sun's axis by the carrier's turn; its own mark turns by -1/3 of the sun's, as Willis says."""
    seen = seated_build(*build_of(runs["wolfrom"], 3))
    (train,) = whole_trains(seen)
    poses = {body.name: body.world_from_part for body in train.bodies}

    def turn(name: str) -> float:
        return math.atan2(poses[name][1, 0], poses[name][0, 0])

    carrier = turn("carrier")
    assert abs(math.sin(carrier)) > 0.1
    assert poses["planet"][:3, 3] == pytest.approx([30 * math.cos(carrier), 30 * math.sin(carrier), 0.0], abs=1e-9)
    off = turn("planet") + turn("sun") / 3
    thirds = off * 3 / (2 * math.pi)  # of whole turns of the sun a third each
    assert thirds == pytest.approx(round(thirds), abs=1e-9)
    assert poses["ring"][:2, 3] == pytest.approx([0.0, 0.0], abs=1e-12)


# what scenes and runs make of them ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            {"fixed_ring": "{kind: reducer, driver: planet, driven: carrier, ratio: 5}"},
            "moves.planets: expected a carrier that turns without this link, got 'carrier', which it drives",
        ),
        (
            {"fixed_ring": "{kind: reducer, driver: motor, driven: carrier, ratio: 5}",
             "sun": "{kind: shaft}\n  motor: {kind: shaft}"},
            "moves.second ring: expected a carrier that 'sun' turns, as it does 'planet', got 'carrier'",
        ),
        (
            {"planets": "{kind: planet, driver: sun, driven: planet, carrier: carrier, teeth: [12, 48], apart: 30 mm}"},
            "moves.planets: expected a shaft that turns, got 'planet', which its driver and its carrier leave at rest",
        ),
        (
            {"pair": "{kind: mesh, driver: pinion, driven: wheel, centre_distance: 60 mm, working_flank: left}",
             "planet": "{kind: shaft, carries: {pinion: {}}}", "ring": "{kind: shaft}"},
            "moves.pair: expected a shaft whose axis rests, got 'planet', whose axis 'carrier' takes round",
        ),
        (
            {"planet": "{kind: shaft}\n  rod: {kind: arm, shaft: planet, points: {tip: [0 mm, 9 mm, 0 mm]}}"},
            "parts.rod: expected a shaft whose axis rests, got 'planet', whose axis 'carrier' takes round",
        ),
        (
            {"from_the_carrier": "{kind: planet, driver: planet, driven: ring, carrier: carrier, teeth: [15, 45], "
             "internal: true, apart: 30 mm}", "with_the_carrier_held": ""},
            "moves.from the carrier: a link on a carrier, 'carrier', cannot close parallel load paths; take out one",
        ),
        (
            {"train": "{kind: train, driven: sun, output: output, ratio: 100}"},
            "moves.train.ratio: expected -105 (its sign may be left out) = that of a train with carriers: "
            "3 (second ring, on 'carrier'), -1.5 (planets, on 'carrier'), got 100",
        ),
        ({"at_the_planet": "{kind: planet_play, of: pair, distribution: {kind: constant, value: 1 arcmin}}"},
         "tolerances.at the planet.of: expected the name of a planet's mesh, got 'pair', which is a mesh of spur"),
        ({"planets": "{kind: planet, driver: sun, driven: sun, carrier: carrier, teeth: [12, 18], apart: 30 mm}"},
         "expected another shaft than the driver, got 'sun'"),
    ],
)  # fmt: skip
def test_what_cannot_turn_is_refused(tmp_path: Path, words: Mapping[str, str], message: str) -> None:
    with pytest.raises(SceneError) as refused:
        model_from_scene(load_scene(rewritten(tmp_path, "wolfrom", **words)))
    assert message in str(refused.value)


def test_kinds_that_extend_gears_need_them(tmp_path: Path) -> None:
    only = replace(PARABOLA, name="only", system="", summary="", presenter="", extends=("gearing",))
    with (
        known(only),
        pytest.raises(InputError, match="kinds of only stand beside those of gearing, and there are none"),
    ):
        run_scene(TOYS / "parabola" / "spring.yaml", out=tmp_path / "run")


def test_what_a_link_s_mechanism_requires_decides_results(runs: Mapping[str, Run]) -> None:
    """The packages of whoever brings a kind that the scene has."""
    assert "jsonschema" in runs["series"].summary["versions"]
    assert "jsonschema" not in dict(installed_versions())


def test_a_trial_is_found_again(runs: Mapping[str, Run]) -> None:
    for name, run in runs.items():
        again = replay(run, 17)
        measure = next(iter(run.summary["measures"]))
        assert again.geometric[measure] == run.columns(f"geometric:{measure}")[f"geometric:{measure}"][17], name


@pytest.mark.slow  # starts processes
def test_workers_give_the_same_bits(runs: Mapping[str, Run], tmp_path: Path) -> None:
    many = Overrides(trials=3000)
    one, two = (
        run_scene(SCENES["series"], overrides=many, out=tmp_path / f"{n}", execution=Execution(workers=n))
        for n in (1, 2)
    )
    for name, column in one.columns().items():
        assert np.array_equal(column, two.columns(name)[name]), name
