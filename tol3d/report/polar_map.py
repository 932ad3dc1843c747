"""Values over directions and angles from an axis, as a picture: a chart has no such axes."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator
from numpy.typing import NDArray

from tol3d.report.canvas import BLACK, VERMILLION, new_figure

Array = NDArray[np.float64]

SIZE: Final = (7.2, 6.2)
COLOURS: Final = "viridis_r"
TITLE_SIZE, WORDS_SIZE = 11.0, 8.0


def polar_map(title: str, azimuths: Array, tilts: Array, values: Array, ends: Array, words: Sequence[str]) -> Figure:
    """Angles outwards, directions around, values above 0 as colours on a logarithmic scale; not yet written.

    Args:
        title: what is shown.
        azimuths: directions, evenly over a turn (rays,) [rad].
        tilts: angles (rays, places) [deg].
        values: (rays, places).
        ends: angles at which each ray ends (rays,) [deg].
        words: lines below the picture.
    """
    figure = new_figure(*SIZE)
    axes: Any = figure.add_subplot(projection="polar")  # PolarAxes, which has more than Axes
    around = np.append(azimuths, azimuths[0] + 2 * np.pi)
    shown = np.ma.masked_invalid(np.vstack([values, values[:1]]))
    low, high = float(shown.min()), float(shown.max())
    drawn = axes.pcolormesh(
        np.repeat(around[:, None], tilts.shape[1], axis=1),
        np.vstack([tilts, tilts[:1]]),
        shown,
        shading="gouraud",
        cmap=COLOURS,
        norm=LogNorm(low, high if high > low else 2 * low),
    )
    axes.plot(around, np.append(ends, ends[0]), color=VERMILLION, linewidth=1.5)
    axes.set_title(title, color=BLACK, fontsize=TITLE_SIZE, fontweight="bold", pad=18)
    axes.grid(color="white", alpha=0.4, linewidth=0.6)
    axes.tick_params(labelsize=WORDS_SIZE)
    axes.set_rlabel_position(112.0)
    ticks = LogLocator(subs=(1.0, 2.0, 5.0))
    figure.colorbar(drawn, ax=axes, pad=0.1, shrink=0.8, ticks=ticks, format="%g").minorticks_off()
    figure.text(0.02, 0.01, "\n".join(words), fontsize=WORDS_SIZE, color=BLACK)
    return figure
