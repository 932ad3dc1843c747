"""Shafts of helical planetary sets that slide: by how much turns follow of the teeth's screws, one equation a mesh."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from gear_trials import drawn_trials, gear_columns, model_of_scene

from tol3d.gearing.engines.gaps import exact_engine
from tol3d.gearing.model import Model

ARCMIN = 10800 / math.pi  # in a radian
PLAYS = {"motor": 70.0, "countershaft": 110.0, "arm": 50.0, "output": 30.0, "ring": 90.0, "planet": 160.0}  # um


@dataclass(frozen=True)
class Toothed:
    """A helical gear as it is drawn; hand 1 right, -1 left; teeth below 0 of a ring."""

    teeth: int
    module: float
    helix: float
    hand: int

    @property
    def screw(self) -> float:
        """Turn for a shift of 1 mm in a mate's teeth at rest: a whole turn in its lead."""
        return self.hand * math.tan(self.helix) / (self.module * abs(self.teeth) / math.cos(self.helix) / 2)

    @property
    def words(self) -> str:
        """As a scene has it."""
        kind = "helical_gear" if self.teeth > 0 else "internal_gear"
        hand = "right" if self.hand > 0 else "left"
        return (
            f"{{kind: {kind}, teeth: {abs(self.teeth)}, module: {self.module} mm, face_width: 12 mm, "
            f"helix_angle: {math.degrees(self.helix)!r} deg, hand: {hand}}}"
        )


def gears(hand: int, lead: int, *, stepped: bool) -> dict[str, Toothed]:
    """Gears of a mesh, a set and a mesh behind it; the sun and the last pinion of these hands."""
    beta, gamma = math.radians(20.0), math.radians(13.9 if stepped else 20.0)
    ring = (-78, 24, 1.55) if stepped else (-84, 30, 1.5)  # teeth, those of its planets' gears, module
    return {
        "first": Toothed(19, 1.0, beta, 1),
        "wheel": Toothed(57, 1.0, beta, -1),
        "sun": Toothed(24, 1.5, beta, hand),
        "P1": Toothed(30, 1.5, beta, -hand),
        "P2": Toothed(ring[1], ring[2], gamma, -hand),
        "ring": Toothed(ring[0], ring[2], gamma, -hand),
        "pinion": Toothed(23, 2.0, beta, lead),
        "last": Toothed(41, 2.0, beta, -lead),
    }


def scene(own: dict[str, Toothed], plays: dict[str, float], *, stepped: bool) -> str:
    """A train of them; teeth have 40 um less than the spaces of wider axes leave them, so that all turn freely."""
    planet = "P1, P2" if stepped else "P1"
    on_ring = "P2" if stepped else "P1"
    lines = (
        f"  {name} play: {{kind: axial_play, of: {name}, distribution: {{kind: constant, value: {size} um}}}}"
        for name, size in plays.items()
    )
    return "\n".join(
        [
            "scene: a set that slides",
            "parts:",
            *(f"  {name}: {gear.words}" for name, gear in own.items() if stepped or name != "P2"),
            f"  planet: {{kind: planet, gears: [{planet}]}}",
            "  carrier: {kind: planet_carrier}",
            "  motor: {kind: shaft, carries: {first: {}}}",
            "  countershaft: {kind: shaft, carries: {wheel: {}, sun: {at: 24 mm}}}",
            "  arm: {kind: shaft, carries: {carrier: {at: 24 mm}, pinion: {at: 60 mm}}}",
            "  output: {kind: shaft, carries: {last: {}}}",
            "tolerances:",
            *lines,
            "  thin sun: {kind: tooth_thickness, of: sun, distribution: {kind: constant, value: -40 um}}",
            "  thin ring: {kind: tooth_thickness, of: ring, distribution: {kind: constant, value: -40 um}}",
            "moves:",
            "  before: {kind: mesh, driver: first, driven: wheel, centre_distance: 40.6 mm}",
            f"  set: {{kind: planetary, planet: planet, planets: 3, carrier: carrier, held: ring, input: sun,"
            f" output: carrier, centre_distance: 43.105 mm, meshes: {{sun: P1, ring: {on_ring}}}}}",
            "  behind: {kind: mesh, driver: pinion, driven: last, centre_distance: 68.3 mm}",
            "  train: {kind: train, driven: motor, output: output}",
            "measures:",
            "  lost: {kind: lost_motion, of: train, over: {at: 20 deg}}",
            "study: {trials: 2, seed: 1}",
        ]
    )


def by_screws(own: dict[str, Toothed], *, stepped: bool) -> float:
    """Turn of the output from end to end of all plays [rad], the motor held.

    Unknown are the turns of countershaft, planets against the carrier, carrier and output: teeth of a mesh go along, in
    a set as its carrier sees them; where a gear slides they are those of a turn of -screw times the shift.
    """
    on_ring = own["P2" if stepped else "P1"]
    rows = np.zeros((4, 4))
    rows[0, 0] = own["wheel"].teeth
    rows[1, :3] = own["sun"].teeth, own["P1"].teeth, -own["sun"].teeth
    rows[2, 1:3] = -on_ring.teeth, own["ring"].teeth
    rows[3, 2:] = own["pinion"].teeth, own["last"].teeth
    moved = {
        "motor": [own["first"].teeth * own["first"].screw, 0.0, 0.0, 0.0],
        "countershaft": [own["wheel"].teeth * own["wheel"].screw, own["sun"].teeth * own["sun"].screw, 0.0, 0.0],
        "arm": [
            0.0,
            own["P1"].teeth * own["P1"].screw,
            -on_ring.teeth * on_ring.screw,
            own["pinion"].teeth * own["pinion"].screw,
        ],
        "output": [0.0, 0.0, 0.0, own["last"].teeth * own["last"].screw],
        "ring": [0.0, 0.0, own["ring"].teeth * own["ring"].screw, 0.0],
        "planet": [0.0, own["P1"].teeth * own["P1"].screw, -on_ring.teeth * on_ring.screw, 0.0],  # all of them alike
    }
    turned = {shaft: np.linalg.solve(rows, np.array(own_row))[3] for shaft, own_row in moved.items()}
    return sum(PLAYS[shaft] / 1000 * abs(turn) for shaft, turn in turned.items())


def lost(text: str, folder: Path) -> tuple[float, float]:
    """Lost motion by the exact and the analytic method [rad]."""
    (path := folder / "set.yaml").write_text(text)
    model: Model = model_of_scene(path)
    columns = gear_columns(model, exact_engine(model), drawn_trials(model, 1, 0, 1))
    return float(columns["geometric:lost"][0]) / ARCMIN, float(columns["analytic:lost"][0]) / ARCMIN


@pytest.mark.parametrize("stepped", [False, True])
@pytest.mark.parametrize(("hand", "lead"), [(1, 1), (-1, 1), (-1, -1)])
def test_shafts_of_a_set_turn_the_output_as_its_teeth_screw(
    stepped: bool, hand: int, lead: int, tmp_path: Path
) -> None:
    own = gears(hand, lead, stepped=stepped)
    slid, still = (lost(scene(own, plays, stepped=stepped), tmp_path) for plays in (PLAYS, dict.fromkeys(PLAYS, 0.0)))
    wanted = by_screws(own, stepped=stepped)
    assert wanted > 5e-4
    assert np.subtract(slid, still) == pytest.approx([wanted] * 2, abs=1e-11)
