"""Draws a run's histogram, and the chains of its trains, in a process of its own.

matplotlib takes as long to load as a whole study of 2000 trials takes to run: so it loads beside the study, and what
is drawn comes at the end, on its standard input:

    python -m tol3d.report.histogram_process < {"picture": "histogram.png", "summary": {...}}

The chain of the first train is drawn as chain.png beside the histogram, that of each further one as
chain-<train>.png. It ends quietly where nothing comes. What goes wrong with the histogram is the one line on its
standard error; what goes wrong with a chain is told on its standard output, {"chain.png": "why"}.
"""

import json
import signal
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from tol3d.report.histogram import draw_histogram
from tol3d.report.picture import chain_files
from tol3d.report.trains.chain import draw_chain


def main() -> None:
    """Wait for what is drawn, and draw it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # a terminal interrupts both processes; the study says what is done
    order = sys.stdin.buffer.read()
    if not order:
        return
    asked = json.loads(order)
    picture, summary = Path(asked["picture"]), asked["summary"]
    print(json.dumps(dict(_refused_chains(summary, picture.parent))), flush=True)
    try:
        draw_histogram(summary, picture)
    except Exception as error:
        sys.exit(_reason(error))


def _refused_chains(summary: Mapping[str, Any], folder: Path) -> Iterator[tuple[str, str]]:
    """Draw the chain of every train; the names of those that could not be drawn, and why."""
    for name, file in chain_files(summary).items():
        try:
            draw_chain(summary, name, folder / file)
        except Exception as error:
            (folder / file).unlink(missing_ok=True)
            yield file, _reason(error)


def _reason(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


if __name__ == "__main__":
    main()
