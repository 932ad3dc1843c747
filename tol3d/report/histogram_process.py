"""Draws a run's histogram, those of its many measures and what its system's presenter draws, in a process of its own.

Loading matplotlib takes as long as a study of 2000 trials: so it loads beside the study, and the order comes at the
end, on its standard input, pickled: where modules are found, then the picture's path, the presenter's module, which
measures are drawn, the kinds of summaries and the summary as JSON.

The presenter's pictures are drawn beside the histogram; where all are wanted also contributors.png, and of many
measures each as histogram-<measure>.png. It ends quietly without an order. An error of the histogram is the one line on
its standard error; errors of other pictures are on its standard output, {"chain.png": "why"}.
"""

import gc
import io
import json
import multiprocessing
import os
import pickle
import signal
import sys
from collections.abc import Iterator, Sequence
from functools import partial
from importlib import import_module
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Final

from tol3d.report.histogram import draw_heat_map, draw_histogram, draw_measure
from tol3d.report.picture import HEAT_MAP, Pictures, measure_files, named_files
from tol3d.report.presenter import Draw, presenter_of
from tol3d.report.share_charts import of_scalars
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.runs.summary.text import typed

FEWEST_EACH: Final = 5  # pictures of a process; for fewer a further one does not pay

PACKAGE: Final = Path(__file__).parents[1]
SUMMARIES: Final = tuple(
    ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts)
    for path in sorted(PACKAGE.rglob("summary_types.py"))
)
"""Modules of the summaries of this package's mechanisms."""


def main() -> None:
    """Wait for what is drawn, and draw it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # a terminal interrupts both processes; the study says what is done
    for module in SUMMARIES:  # most orders need them: loaded while waiting
        import_module(module)
    order = io.BytesIO(sys.stdin.buffer.read())
    if not order.getbuffer():
        return
    sys.path += [path for path in pickle.load(order) if path and path not in sys.path]  # mechanisms may lie anywhere
    picture, presenter, pictures, kinds, found = pickle.load(order)
    summary = typed(json.loads(found), lambda place, words: ValueError(f"{place}: {words}"), kinds)
    whole = (picture.name, partial(draw_histogram, summary, pictures=pictures))
    refused = _refused([whole, *_further(summary, presenter, pictures)], picture.parent)
    reason = refused.pop(picture.name, "")
    print(json.dumps(refused), flush=True)
    if reason:
        sys.exit(reason)


def _further(summary: RunSummary, presenter: str | None, wanted: Pictures) -> Iterator[tuple[str, Draw]]:
    """Files besides the histogram, and the functions that draw them."""
    pictures = presenter_of(summary, presenter).pictures(summary)
    yield from ((file, pictures[name]) for name, file in named_files(pictures).items())
    if wanted is Pictures.ALL:
        files = measure_files(summary.measures)
        yield from ((file, partial(draw_measure, summary, name)) for name, file in files.items())
        if len(of_scalars(summary)) > 1:
            yield HEAT_MAP, partial(draw_heat_map, summary)


def _refused(pictures: Sequence[tuple[str, Draw]], folder: Path) -> dict[str, str]:
    """Draw pictures, many of them by as many processes as there are processors; those that failed, and why."""
    count = max(1, min(len(pictures) // FEWEST_EACH, len(os.sched_getaffinity(0))))
    fork = multiprocessing.get_context("fork")  # matplotlib and the summary are loaded already
    helping: list[tuple[Connection, Sequence[tuple[str, Draw]]]] = []
    for share in (pictures[k::count] for k in range(1, count)):
        receiver, sender = fork.Pipe(duplex=False)
        fork.Process(target=_send_refused, args=(share, folder, sender), daemon=True).start()
        sender.close()
        helping.append((receiver, share))
    refused = _drawn(pictures[::count], folder)
    for receiver, share in helping:
        try:
            refused |= receiver.recv()
        except EOFError:
            for file, _ in share:
                (folder / file).unlink(missing_ok=True)
                refused[file] = "its process ended"
    return refused


def _send_refused(pictures: Sequence[tuple[str, Draw]], folder: Path, sender: Connection) -> None:
    sender.send(_drawn(pictures, folder))


def _drawn(pictures: Sequence[tuple[str, Draw]], folder: Path) -> dict[str, str]:
    """Draw pictures one after the other; those that failed, and why."""
    refused = {}
    for file, draw in pictures:
        try:
            draw(folder / file)
        except Exception as error:
            (folder / file).unlink(missing_ok=True)
            refused[file] = _reason(error)
    return refused


def _reason(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


if __name__ == "__main__":
    try:
        main()
    finally:
        gc.freeze()  # else Python traverses all of it again on exit
