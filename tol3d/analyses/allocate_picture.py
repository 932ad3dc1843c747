"""The picture of allocated tolerances: their factors, and cost over ppm."""

from pathlib import Path
from typing import Final

from tol3d.analyses.allocation_section import Allocation
from tol3d.report.canvas import BLACK, BLUE, GREY, ORANGE, VERMILLION, new_figure, plain_axes, save_figure
from tol3d.report.label import legible

WIDTH: Final = 12.0  # inch
ROW: Final = 0.26
HEAD: Final = 1.6
LEAST_HEIGHT: Final = 4.0


def draw_allocation(name: str, found: Allocation, path: Path) -> None:
    """Draw it: `path` ends in .png, .svg or .pdf.

    Raises:
        InputError: the picture cannot be written there.
    """
    figure = new_figure(WIDTH, max(LEAST_HEIGHT, ROW * len(found.tolerances) + HEAD))
    title = f"{name} · tolerances at least cost, {found.cost:.4g}"
    figure.suptitle(legible(title, len(title)), fontsize=11, color=BLACK, x=0.01, ha="left")
    left, right = figure.subplots(1, 2, width_ratios=[1.3, 1])
    plain_axes(left)
    rows = list(found.tolerances.items())[::-1]
    colours = [GREY if own.held and "bound" not in own.held else BLUE for _, own in rows]
    left.barh([legible(own) for own, _ in rows], [own.factor for _, own in rows], color=colours, height=0.7)
    left.axvline(1.0, color=BLACK, linewidth=0.8)
    if found.equal_factor is not None:
        left.axvline(found.equal_factor, color=ORANGE, linestyle="--")
    dashed = "" if found.equal_factor is None else f"; dashed: equal factors, {found.equal_factor:.3g}"
    left.set_xlabel(f"factor of the scene's tolerance; grey: held by more than a bound{dashed}", fontsize=9)
    plain_axes(right)
    known = [(own.ppm, own.cost) for own in found.trade_off if own.cost is not None]
    right.semilogx([ppm for ppm, _ in known], [cost for _, cost in known], "o-", color=BLUE, label="least cost")
    if found.equal_cost is not None and found.targets:
        right.plot(found.targets[0].wanted, found.equal_cost, "s", color=ORANGE, label="equal factors")
    if found.targets:
        own = found.targets[0]
        low, high = own.ppm - own.interval[0], own.interval[1] - own.ppm
        right.errorbar(
            own.ppm, found.cost, xerr=[[low], [high]], color=VERMILLION, capsize=3, fmt="D", label="confirmed"
        )
    right.set_xlabel("ppm out of limits", fontsize=9)
    right.set_ylabel("cost", fontsize=9)
    right.legend(fontsize=8.5, frameon=False)
    save_figure(figure, path)
