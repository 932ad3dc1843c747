"""Draws a run's histogram, those of its many measures and what its system's presenter draws, in a process of its own.

matplotlib takes as long to load as a whole study of 2000 trials takes to run: so it loads beside the study, and what
is drawn comes at the end, on its standard input, pickled: where modules are found, then the picture's path, the
presenter's module, which measures are drawn, the kinds of summaries and the summary as JSON.

The presenter's pictures are drawn beside the histogram; where all are wanted also contributors.png, and of many
measures each as histogram-<measure>.png. It ends quietly where nothing comes. What goes wrong with the histogram is the
one line on its standard error; of another picture it stands on its standard output, {"chain.png": "why"}.
"""

import gc
import io
import json
import pickle
import signal
import sys
from collections.abc import Iterable, Iterator
from functools import partial
from importlib import import_module
from pathlib import Path

from tol3d.report.heat_map import draw_heat_map, of_scalars
from tol3d.report.histogram import draw_histogram, draw_measure
from tol3d.report.picture import HEAT_MAP, Pictures, measure_files, named_files
from tol3d.report.presenter import Draw, presenter_of
from tol3d.runs.summary.run import RunSummary
from tol3d.runs.summary.text import typed

SUMMARIES = tuple(
    f"tol3d.{path.parent.name}.{path.stem}" for path in sorted(Path(__file__).parents[1].glob("*/summary_types.py"))
)
"""What runs of this package's mechanisms have in their summaries."""


def main() -> None:
    """Wait for what is drawn, and draw it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # a terminal interrupts both processes; the study says what is done
    for module in SUMMARIES:  # of which most orders have the kinds: loaded while waiting
        import_module(module)
    order = io.BytesIO(sys.stdin.buffer.read())
    if not order.getbuffer():
        return
    sys.path += [path for path in pickle.load(order) if path and path not in sys.path]  # mechanisms may lie anywhere
    picture, presenter, pictures, kinds, found = pickle.load(order)
    summary = typed(json.loads(found), lambda place, words: ValueError(f"{place}: {words}"), kinds)
    print(json.dumps(dict(_refused(_further(summary, presenter, pictures), picture.parent))), flush=True)
    try:
        draw_histogram(summary, picture, pictures)
    except Exception as error:
        sys.exit(_reason(error))


def _further(summary: RunSummary, presenter: str | None, wanted: Pictures) -> Iterator[tuple[str, Draw]]:
    """Files besides the histogram, and what draws them."""
    pictures = presenter_of(summary, presenter).pictures(summary)
    yield from ((file, pictures[name]) for name, file in named_files(pictures).items())
    if wanted is Pictures.ALL:
        files = measure_files(summary.measures)
        yield from ((file, partial(draw_measure, summary, name)) for name, file in files.items())
        if len(of_scalars(summary)) > 1:
            yield HEAT_MAP, partial(draw_heat_map, summary)


def _refused(further: Iterable[tuple[str, Draw]], folder: Path) -> Iterator[tuple[str, str]]:
    """Draw the further pictures; the names of those that failed, and why."""
    for file, draw in further:
        try:
            draw(folder / file)
        except Exception as error:
            (folder / file).unlink(missing_ok=True)
            yield file, _reason(error)


def _reason(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


if __name__ == "__main__":
    try:
        main()
    finally:
        gc.freeze()  # else Python looks through all of it again while it ends
