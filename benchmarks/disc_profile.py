"""A lobe of a cycloid disc and its pins, and what the modification leaves between: makes docs/cycloid_profile.png.

    python benchmarks/disc_profile.py [--shift -20] [--offset -12.795] [--rotation 0] [--out docs/cycloid_profile.png]

The disc of scene rv_250aii; shift and offset in um, the rotation in arc seconds. Prints what the page says of it.
"""

import argparse
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle
from numpy.typing import NDArray

from tol3d.gearing.cycloid.model.limits import least_gap, neighbours_touch_at
from tol3d.gearing.cycloid.model.profile import UNMODIFIED, DiscProfile, Modification
from tol3d.report.canvas import BLACK, BLUE, GREY, ORANGE, legend_below, new_figure, plain_axes, save_figure

Array = NDArray[np.float64]

ROOT: Final = Path(__file__).resolve().parent.parent
WIDTH: Final = 11.0  # inch
HEIGHT: Final = 5.6
STEPS: Final = 400  # points of a lobe
DRAWN_SHARE: Final = 0.5  # of a pin's radius: the largest clearance as it is drawn
ROUND: Final = (1, 2, 5)
ARC_SECOND: Final = math.pi / 648_000
SHORTEST_LEVER: Final = 0.5  # of the longest; below, the turn until contact says nothing


def draw_profile(profile: DiscProfile, path: Path) -> None:
    """Lobes and pins with the clearance magnified; clearance, lever and turn until contact over the phase.

    Raises:
        InputError: the picture cannot be written there.
    """
    figure = new_figure(WIDTH, HEIGHT)
    lobes, curves = figure.subplots(1, 2, width_ratios=(1.0, 1.15))
    _draw_lobes(plain_axes(lobes), profile)
    _draw_clearance(plain_axes(curves), profile)
    save_figure(figure, path)


def magnified_by(profile: DiscProfile) -> float:
    """1, 2 or 5 times a power of ten, so that the largest clearance fills about half of a pin's radius; 1 for none."""
    most = float(np.abs(profile.clearance(np.linspace(0.0, profile.lobe_pitch, STEPS))).max())
    if most == 0.0:
        return 1.0
    wanted = max(1.0, DRAWN_SHARE * profile.pin_radius / most)
    power = 10.0 ** math.floor(math.log10(wanted))
    return max(power * digit for digit in ROUND if power * digit <= wanted)


def _draw_lobes(axes: Axes, profile: DiscProfile) -> None:
    """One lobe, upright, and pins at some phases of either flank."""
    best = profile.best_phase / profile.lobes
    shown = np.array([0.0, best, profile.lobe_pitch / 2])
    u = np.linspace(-0.15, 1.15, STEPS) * profile.lobe_pitch
    normals, centres = replace(profile, modification=UNMODIFIED).normals(u), profile.pin_centres(u)
    plain, factor = centres - profile.pin_radius * normals, magnified_by(profile)
    ground = plain - factor * profile.clearance(u)[:, None] * normals
    for place in _upright(profile, profile.pin_centres(np.concatenate([shown, profile.lobe_pitch - shown[:2]]))):
        axes.add_patch(Circle((place[0], place[1]), profile.pin_radius, fill=False, color=GREY, linewidth=0.8))
    axes.plot(*_upright(profile, centres).T, color=GREY, linewidth=0.8, linestyle=":", label="path of pin centres")
    axes.plot(*_upright(profile, plain).T, color=BLACK, linewidth=1.0, label="profile that touches every pin")
    words = f"as it is ground, its clearance drawn {factor:g} times"
    axes.plot(*_upright(profile, ground).T, color=ORANGE, linewidth=1.6, label=words)
    axes.set_aspect("equal")
    axes.set_xlabel("[mm]", fontsize=10)
    axes.set_title("one lobe and its pins", loc="left", fontsize=12, fontweight="bold", color=BLACK)
    legend_below(axes)


def _upright(profile: DiscProfile, points: Array) -> Array:
    """Points turned so that the middle of lobe 0 stands on +y."""
    angle = math.pi / 2 - profile.lobe_pitch / 2
    cos, sin = math.cos(angle), math.sin(angle)
    return np.asarray(points @ np.array([[cos, sin], [-sin, cos]]))


def _draw_clearance(axes: Axes, profile: DiscProfile) -> None:
    phase = np.linspace(0.0, math.pi, STEPS)
    u = phase / profile.lobes
    clearance, lever = profile.clearance(u), profile.lever(u)
    degrees = np.degrees(phase)
    axes.plot(degrees, 1e3 * clearance, color=ORANGE, linewidth=1.6, label="clearance along the normal [µm]")
    works = lever > SHORTEST_LEVER * profile.pitch_radius
    turn = clearance[works] / lever[works] / ARC_SECOND
    axes.plot(degrees[works], turn, color=BLUE, linewidth=1.6, label="turn of the disc until contact [″]")
    best = math.degrees(profile.best_phase)
    label = f"longest lever: {profile.pitch_radius:.3f} mm at {best:.2f}°"
    axes.axvline(best, color=GREY, linewidth=1.0, linestyle="--", label=label)
    axes.set_xlim(0.0, 180.0)
    axes.set_xlabel("phase of the pin [°]: 0 in a root, 180 at a tip", fontsize=10)
    axes.set_title("what the modification leaves", loc="left", fontsize=12, fontweight="bold", color=BLACK)
    legend_below(axes)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the numbers of the profile and draw it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shift", type=float, default=-20.0, help="um")
    parser.add_argument("--offset", type=float, default=-12.795, help="um")
    parser.add_argument("--rotation", type=float, default=0.0, help="arc seconds")
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "cycloid_profile.png")
    given = parser.parse_args(arguments)
    ground = Modification(1e-3 * given.shift, 1e-3 * given.offset, ARC_SECOND * given.rotation)
    profile = DiscProfile(40, 114.5, 5.0, 2.2, ground)
    flank = profile.clearance(np.linspace(0.0, profile.lobe_pitch / 2, STEPS))
    print(f"longest lever            {profile.pitch_radius:10.4f} mm at {math.degrees(profile.best_phase):.2f} deg")
    print(f"smallest convex radius   {profile.smallest_convex_radius:10.4f} mm")
    print(f"neighbouring pins touch  {neighbours_touch_at(profile):10.4f} mm")
    print(f"largest clearance        {1e3 * flank.max():10.4f} um, the least {1e3 * least_gap(profile):.4f} um")
    draw_profile(profile, given.out)


if __name__ == "__main__":
    main()
