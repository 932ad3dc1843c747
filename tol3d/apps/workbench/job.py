"""Process of a job: it waits for its turn, does its work, and says how it ended.

    python -P -m tol3d.apps.workbench.job FOLDER NUMBER [--trust-parts] [--run-builders]

Until its turn it loads nothing that computes. What the user allows a scene comes on the command line, from the app: an
order may lie there as a stranger wrote it.
"""

import signal
import sys
import traceback
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Final

from tol3d.apps.workbench.attempt import STARTS_WITHIN, Attempt, Order, Said
from tol3d.apps.workbench.monitor import Monitor
from tol3d.apps.workbench.words import OPTION
from tol3d.errors import InputError, MechanismError
from tol3d.import_path import named

WORK: Final = "tol3d.apps.workbench.work:work"
TRUSTED: Final = {"trust_parts": "--trust-parts", "run_builders": "--run-builders"}
"""Options by the arguments of `run_scene`."""


def main(folder: str, number: str, *options: str) -> None:
    """Do a job.

    Args:
        folder: the opened folder.
        number: of the attempt.
        options: of those in TRUSTED.
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell that starts the app by `&` has it ignored
    attempt = Attempt(Path(folder), int(number))
    order = attempt.order()
    if order is None:
        return
    state: Said = "cancelled"
    message = ""
    with attempt.lock.acquire(timeout=STARTS_WITHIN):
        monitor = Monitor(attempt)
        attempt.write(monitor.now)
        try:
            with monitor:
                state, message = _ended(attempt, order, monitor, options)
        except KeyboardInterrupt:
            pass
        attempt.write(replace(monitor.now, state=state, message=message))


def _ended(attempt: Attempt, order: Order, monitor: Monitor, options: tuple[str, ...]) -> tuple[Said, str]:
    """State at the end, and the message for the user."""
    trusted = {argument: option in options for argument, option in TRUSTED.items()}
    try:
        attempt.wait_for_earlier()
        now = datetime.now().astimezone().isoformat(timespec="seconds")
        monitor.now = replace(monitor.now, state="running", started=now, words="starting")
        return "done", named(WORK)(attempt, order, monitor, trusted)
    except (InputError, MechanismError) as error:
        return "failed", OPTION.sub(r"\1: ", str(error))
    except MemoryError:
        return "failed", "out of memory: the input is not at fault; finished blocks are kept, and resuming goes on"
    except Exception as error:
        traceback.print_exc()
        words = f"a fault in tol3d, not in your scene: {type(error).__name__}: {error}"
        return "failed", f"{words}; please report it with the scene and {attempt.place / 'output.txt'}"


if __name__ == "__main__":
    main(*sys.argv[1:])
