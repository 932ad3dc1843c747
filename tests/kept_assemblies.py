"""Some three hundred assemblies of every move, each with a few trials, and what both methods found of them.

They are the random ones that other tests hold against oracles, many of them drawn askew and up to 600 mm off.
kept_trials.npz has their values of commit ed08464c, before one solver took the place of many; of 074484e9 only where
results had changed since: random floats of patterns and gauges (uniform in their room) and gaps of surfaces (over the
length that both have). Of 41cfa49e are 14 of pins and bolts, of another solver: pushed and random covers lie nearer to
where planes that cut the cones say, by up to 3e-6 mm; pins along which slack is flat are as near as before, to 1e-7 mm.
Of 74d4ac7d are analytic trials of three covers on loose bolts, by the same solver: see changelog.md. Of 91d8ae18 are
six of those, since when what nothing holds stays where it is; of 11538d33 analytic trials on gauges, since when no
rounding of a processor is in their freedoms (4e-7 mm).
After a wanted change `python tests/kept_assemblies.py COMMIT` writes what is no longer so.
"""

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from assembly import test_pattern_datums, test_together
from assembly.framed_parts import MOVES, scene
from assembly.placing.one_sided_parts import random_contacts, random_pads
from assembly.placing.test_best_fitting import fitted, random_points
from assembly.placing.test_locating import random_move
from assembly.plates_with_pins import pinned_plates
from assembly.random_touches import KINDS, random_touch
from assembly.test_bolts import FOUR, TWO, joint
from assembly.test_gauged_pattern import holes
from assembly.test_gauged_rooms import FRAMES as GAUGED
from assembly.test_gauged_rooms import ROOM, gauged
from assembly.test_inspected_sets import scene as sets
from assembly.test_later_datums import FRAMES as LATER
from assembly.test_later_datums import plate as later
from assembly.test_leaning_pattern import case as leaning
from assembly.test_play import key
from assembly.test_pressed_touches import corner
from assembly.test_rest_chain import stacked
from assembly.test_rest_methods import SEEN
from assembly.test_rest_relations import on_pads
from assembly.test_shifted_coordinates import FAR_OFF, askew, datums_in, every_move
from assembly.test_shifted_coordinates import FRAMES as DATUMS
from assembly.test_tied_patterns import cover, pushed_plate
from assembly.test_virtual_clearance import LEANING, sheets
from assembly_trials import Assembled, assembled
from numpy.typing import NDArray
from places import SCENES, TESTS
from scipy.spatial.transform import Rotation
from shipped import shipped

from tol3d.assembly.grammar.measures.gap import GapSpec
from tol3d.assembly.model import Assembly, Floating, Locate, Measured, Relation, Touch
from tol3d.assembly.placing import method as placing
from tol3d.assembly.torsors import method as torsors
from tol3d.simulate import Overrides, load, simulation_of
from tol3d.study.trials.draws import drawn

KEPT = TESTS / "assembly" / "kept_trials.npz"
TOLERANCE = 1e-9
"""mm or rad"""
LOOSE = {"pins": 2e-6, "bolts 9": 5e-7, "fit 7": 5e-5, "fit 3": 5e-3}
"""The same of a family or a case whose last digits a processor's own sums decide: pins lean along a slack that is flat,
and of these fits what lies below the largest residuals is not settled."""
Array = NDArray[np.float64]
Built = tuple[Assembly, Array]
"""An assembly, and deviations of its trials (trials, columns)."""

TRIALS = 5
FLOATS = ("{kind: centred}", "{kind: random}", "{kind: toward, along: [0.8, 0.6, 0], at: upper.edge}")


@dataclass(frozen=True)
class Found:
    """Values of an assembly's measures in its trials.

    Args:
        exact, analytic: values by both methods (measures, trials) [mm or rad].
        codes: statuses of the exact method (measures, trials).
        deviations: a number that any other deviations change.
        commit: at which they were found.
    """

    exact: Array
    codes: NDArray[np.int8]
    analytic: Array
    deviations: float
    commit: str = ""

    def agrees(self, other: "Found", tolerance: float) -> bool:
        """True if statuses are the same, and values within a tolerance."""
        return np.array_equal(self.codes, other.codes) and all(
            np.allclose(own, its, rtol=0, atol=tolerance, equal_nan=True)
            for own, its in ((self.exact, other.exact), (self.analytic, other.analytic))
        )


def tolerance_of(case: str) -> float:
    """Tolerance of a case such as "touch 7" [mm or rad]."""
    return LOOSE.get(case) or LOOSE.get(case.rpartition(" ")[0], TOLERANCE)


def found(assembly: Assembly, rows: Array) -> Found:
    """Values by both methods."""
    names = list(assembly.measures)
    exact, linear = placing.values(assembly, rows, names), torsors.values(assembly, rows, names)
    return Found(
        np.array([exact[name][0] for name in names]),
        np.array([exact[name][1] for name in names], dtype=np.int8),
        np.array([linear[name] for name in names]),
        float(rows.ravel() @ np.cos(np.arange(rows.size))),
    )


def of_scene(made: Assembled, count: int = TRIALS) -> Built:
    """The first trials of a scene, without clearances of solids."""
    assembly = made.system.assembly
    read = {name: own for name, own in assembly.measures.items() if own.kind != "clearance"}
    return replace(assembly, measures=read), drawn(made.simulation, 0, count).deviations


def of_text(text: str, folder: Path, seed: int | None = None) -> Built:
    """The first trials of a scene as a text; with a seed its parts are drawn askew."""
    assembly, rows = of_scene(assembled(text, folder))
    return (assembly if seed is None else askew(assembly, seed)), rows


def normal(assembly: Assembly, seed: int, sigma: float) -> Built:
    """Deviations of one sigma [mm]; every other assembly is drawn askew."""
    rows = np.random.default_rng(seed).normal(0.0, sigma, (TRIALS, assembly.width))
    return (askew(assembly, seed) if seed % 2 else assembly), rows


# each of a family by its index -------------------------------------------------------------------------------


def any_frame(k: int, folder: Path) -> Built:
    return of_text(scene(list(MOVES)[k % len(MOVES)], k, 1.0), folder)


def every(k: int, folder: Path) -> Built:
    assembly, rows = of_scene(every_move(folder))
    return (askew(assembly, k) if k else assembly), rows


def touch(k: int, folder: Path) -> Built:
    made = random_touch(k, kinds=(KINDS[k],)) if k < len(KINDS) else random_touch(k)
    return normal(made.assembly, k, 0.05)


def pressed(k: int, folder: Path) -> Built:
    assembly, normals = corner(socket=bool(k % 2))
    put, move = assembly.moves
    assert isinstance(move, Touch)
    force = -normals.T @ np.random.default_rng(k).uniform(0.2, 1.0, 3)
    own = replace(assembly, moves=(put, replace(move, pressed=force / np.linalg.norm(force))))
    return normal(own, k, (0.05, 2.0)[k // 2 % 2])


def locate(k: int, folder: Path) -> Built:
    assembly, *_ = random_move(k, "part" if k % 2 else "fixture")
    (move,) = (own for own in assembly.moves if isinstance(own, Locate))
    measures = {
        f"{pair.moving} {axis}": Measured(GapSpec.reads, (pair.target, pair.moving), along)
        for pair in move.pairs[:2]
        for axis, along in zip("xyz", np.eye(3), strict=True)
    }
    return normal(replace(assembly, measures=measures), k, 0.1)


def fit(k: int, folder: Path) -> Built:
    points, pose = random_points(rng := np.random.default_rng(k))
    weights = rng.uniform(0.5, 2.0, len(points)) if k % 2 else None
    return normal(fitted(points, "minimax" if k % 2 else "squares", np.eye(3), weights, pose), k // 2, 0.3)


def rest(k: int, folder: Path) -> Built:
    rng = np.random.default_rng(k)
    if k % 2:
        rocking = ("least", "largest", None)[k // 2 % 3]
        return normal(random_pads(rng).rested(seen=SEEN, rocking=rocking), k // 2, 0.1)  # type: ignore[arg-type]
    return normal(random_contacts(rng).rested(None, "fixture" if k % 4 else "part", SEEN), k // 2, 0.1)


def far_off(k: int, folder: Path) -> Built:
    """Deviations of which many builds fail: parts that do not touch, tip or have no pose."""
    family, sigma = ((touch, 6.0), (locate, 10.0), (rest, 12.0))[k % 3]
    assembly, _ = family(20 + k // 3, folder)
    return assembly, np.random.default_rng(k).normal(0.0, sigma, (TRIALS, assembly.width))


def related(k: int, folder: Path) -> Built:
    relations = (Relation("coincident", "plate.hole", "base.pin"),), (Relation("coaxial", "plate.bore", "base.pin"),)
    return normal(on_pads(relations[k % 2]), k // 2, 0.1)


def chain(k: int, folder: Path) -> Built:
    return normal(stacked(("least", "largest")[k % 2], welded=bool(k // 2 % 2)), k, 0.05)


def pins(k: int, folder: Path) -> Built:
    rng = np.random.default_rng(k)
    at = [(float(x), float(y)) for x, y in np.round(rng.uniform(-60, 60, (int(rng.integers(2, 7)), 2)), 3)]
    text = pinned_plates(at, float(rng.choice([10.03, 10.05, 10.2])), 10.0, FLOATS[k % 3])
    return of_text(text, folder, k if k % 2 else None)


def lean(k: int, folder: Path) -> Built:
    made = leaning(k, folder, FLOATS[k % 3], 0.06)
    return (askew(made.made.system.assembly, k) if k % 2 else made.made.system.assembly), made.rows


def bolts(k: int, folder: Path) -> Built:
    floating = ("{kind: centred}", "{kind: random}", "{kind: toward, along: [1, 0, 0], at: cover.hole 0}")[k % 3]
    made = joint(
        (TWO, FOUR)[k // 3 % 2], folder, floating, apart=2.0 * (k % 2), zones=bool(k // 2 % 2), screw=False,
        more="  least: {kind: gap, from: base.hole 0, to: cover.hole 0, along: [0, 1, 0], over_play: least}\n",
    )  # fmt: skip
    assembly, rows = of_scene(made)
    return (askew(assembly, k) if k % 4 == 1 else assembly), rows


def tied(k: int, folder: Path) -> Built:
    return of_scene(cover(FLOATS[k], folder))


def pushed(k: int, folder: Path) -> Built:
    text = pushed_plate((10.12, 10.4)[k % 2], ((0, 1), (0.8, 0.6))[k // 2])
    return of_text(text, folder, k if k % 2 else None)


def keyed(k: int, folder: Path) -> Built:
    floats = ("{kind: centred}", "{kind: random}", "{kind: toward, along: [0, -1, 0], at: key.tip}")
    return of_text(key(20.03, floats[k]), folder, k)


def gauges(k: int, folder: Path) -> Built:
    (kept, at), kind = GAUGED[k % len(GAUGED)], k // len(GAUGED)
    _, bare = gauged(kept, at, None)
    rng = np.random.default_rng(k)
    rows = rng.normal(0.0, 0.01, (TRIALS, bare.width))
    if kind == 0:
        return (askew(bare, k) if k % 2 else bare), rows
    floating = Floating("centred") if kind == 1 else Floating("random", slice(bare.width, bare.width + 7))
    assembly = replace(gauged(kept, at, floating)[1], width=bare.width + 7)
    rows = np.hstack([rows, rng.uniform(-1.0, 1.0, (TRIALS, 7))])
    return (askew(assembly, k) if k % 2 else assembly), rows


def later_datum(k: int, folder: Path) -> Built:
    words, rng = LATER[k % len(LATER)], np.random.default_rng(k)
    _, bare = later(words, ROOM, None)
    rows = rng.normal(0.0, 0.01, (TRIALS, bare.width))
    if k < len(LATER):
        return bare, rows
    _, assembly = later(words, ROOM, Floating("random", slice(bare.width, bare.width + 7)), 7)
    return (askew(assembly, k) if k % 2 else assembly), np.hstack([rows, rng.uniform(-1.0, 1.0, (TRIALS, 7))])


def datums(k: int, folder: Path) -> Built:
    assembly, rows = datums_in(DATUMS[k])
    return (askew(assembly, k) if k % 2 else assembly), rows


def pattern_datums(k: int, folder: Path) -> Built:
    return normal(test_pattern_datums.plate(*test_pattern_datums.FRAMES[k])[1], k, 0.02)


def inspected(k: int, folder: Path) -> Built:
    match k:
        case 0 | 1:
            return of_text(holes(", modifier: mmc" if k else ""), folder, k)
        case 2 | 3:
            rng = np.random.default_rng(k)
            return of_text(sets(Rotation.random(rng=rng).as_matrix(), rng.uniform(-FAR_OFF, FAR_OFF, 3)), folder)
        case 4 | 5:
            return of_text(test_together.plate(modifier=", modifier: mmc" if k == 4 else "", x=200.0), folder)
        case 6:
            return of_text(LEANING, folder, k)
    return of_text(sheets(k - 5), folder)


BUNDLED = shipped("assembly")


def bundled(k: int, folder: Path) -> Built:
    return of_scene(Assembled(simulation_of(load(SCENES / f"{BUNDLED[k]}.yaml"), Overrides())))


FAMILIES: Mapping[str, tuple[int, Callable[[int, Path], Built]]] = {
    "any frame": (21, any_frame),
    "every move": (3, every),
    "touch": (48, touch),
    "pressed": (8, pressed),
    "locate": (8, locate),
    "fit": (12, fit),
    "rest": (24, rest),
    "far off": (18, far_off),
    "related": (4, related),
    "chain": (4, chain),
    "pins": (24, pins),
    "lean": (12, lean),
    "bolts": (12, bolts),
    "tied": (2, tied),
    "pushed": (4, pushed),
    "keyed": (3, keyed),
    "gauges": (33, gauges),
    "later datum": (16, later_datum),
    "datums": (len(DATUMS), datums),
    "pattern datums": (len(test_pattern_datums.FRAMES), pattern_datums),
    "inspected": (10, inspected),
    "bundled": (len(BUNDLED), bundled),
}
CASES: Sequence[tuple[str, int]] = [(name, k) for name, (count, _) in FAMILIES.items() for k in range(count)]


def made(family: str, k: int, folder: Path) -> Built:
    """An assembly and its trials."""
    return FAMILIES[family][1](k, folder)


# the file ----------------------------------------------------------------------------------------------------


def kept() -> Mapping[str, Found]:
    """Those that the file holds, by family and index, such as "touch 7"."""
    if not KEPT.exists():
        return {}
    with np.load(KEPT) as file:
        ends = np.cumsum(np.prod(file["shapes"], axis=1))[:-1]
        values = [np.split(file[name], ends) for name in ("exact", "codes", "analytic")]
        return {
            str(name): Found(exact.reshape(shape), codes.reshape(shape), linear.reshape(shape), drawn_as, str(commit))
            for name, shape, exact, codes, linear, drawn_as, commit in zip(
                file["cases"], file["shapes"], *values, file["deviations"], file["commits"], strict=True
            )
        }


def write(commit: str) -> None:
    """Write the file: those that it has stay where they agree, the others are as they are found now, at a commit."""
    before, after = kept(), dict[str, Found]()
    with TemporaryDirectory() as folder:
        for family, k in CASES:
            name, now = f"{family} {k}", replace(found(*made(family, k, Path(folder))), commit=commit)
            agrees = name in before and before[name].agrees(now, tolerance_of(name))
            after[name] = before[name] if agrees else now
            if not agrees:
                print(name)
    every = list(after.values())
    np.savez_compressed(
        KEPT, cases=list(after), shapes=[own.codes.shape for own in every],
        exact=np.concatenate([own.exact.ravel() for own in every]),
        codes=np.concatenate([own.codes.ravel() for own in every]),
        analytic=np.concatenate([own.analytic.ravel() for own in every]),
        deviations=[own.deviations for own in every], commits=[own.commit for own in every],
    )  # fmt: skip


if __name__ == "__main__":  # python tests/kept_assemblies.py COMMIT
    write(sys.argv[1])
