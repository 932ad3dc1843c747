"""Draws a run's histogram in a process of its own.

matplotlib takes as long to load as a whole study of 2000 trials takes to run: so it loads beside the study, and what
is drawn comes at the end, on its standard input:

    python -m tol3d.report.histogram_process < {"picture": "histogram.png", "summary": {...}}

It ends quietly where nothing comes. What goes wrong is the one line on its standard error.
"""

import json
import signal
import sys
from pathlib import Path

from tol3d.report.histogram import draw_histogram


def main() -> None:
    """Wait for what is drawn, and draw it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # a terminal interrupts both processes; the study says what is done
    order = sys.stdin.buffer.read()
    if not order:
        return
    asked = json.loads(order)
    try:
        draw_histogram(asked["summary"], Path(asked["picture"]))
    except Exception as error:
        sys.exit(" ".join(str(error).split()) or type(error).__name__)


if __name__ == "__main__":
    main()
