"""Command of the app."""

import logging
import socket
import stat
import sys
import tempfile
import threading
import time
import webbrowser
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from tol3d.cli.arguments import RunBuilders, TrustParts
from tol3d.cli.console import out_console, tell, warn
from tol3d.errors import InputError

if TYPE_CHECKING:
    from tol3d.apps.workbench.jobs import Jobs

LOOK_S: Final = 60.0  # s; how often is looked whether anybody is there


def app(
    place: Annotated[
        str,
        typer.Argument(
            metavar="SCENE|FOLDER",
            help="A scene, a folder of scenes, or the name of a bundled scene, copied here.",
        ),
    ] = ".",
    port: Annotated[int, typer.Option(min=0, max=65535, help="Of 127.0.0.1; 0: one that is free.")] = 0,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page in the browser.")] = True,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Open scenes in the browser: the assembly, its distribution, and tolerances to move by hand."""
    import uvicorn

    from tol3d.apps.workbench.place import FolderLock
    from tol3d.apps.workbench.server import Server, application
    from tol3d.apps.workbench.workspace import Workspace, is_bundled

    workspace = Workspace.of(_copied(place) if is_bundled(place) else Path(place))
    lock = FolderLock(workspace.folder)
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as listening:
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listening.bind(("127.0.0.1", port))
            listening.listen()  # a browser that is quicker than the server waits
        except OSError as error:
            raise InputError(f"--port {port}: {error.strerror}; leave it out for one that is free") from None
        own = listening.getsockname()[1]
        server = Server(workspace, lock, trust_parts, run_builders)
        guarded = application(server, own)
        address = f"{guarded.origin}/#{guarded.token}"
        out_console.print(f"{workspace.folder.name}: {address}", soft_wrap=True, highlight=False)
        out_console.print("Ctrl-C ends it")
        if lock.refusal:
            warn(lock.refusal)
        quiet: dict[str, Any] = {"log_level": "warning", "access_log": False, "server_header": False}
        config = uvicorn.Config(guarded, **quiet, lifespan="off", ws="none", timeout_graceful_shutdown=2)
        with tempfile.TemporaryDirectory(prefix="tol3d-page-") as folder:
            if browser and not webbrowser.open(_opener(Path(folder), address).as_uri()):
                warn("no browser could be opened: open the address above in one on this computer")
            serving = uvicorn.Server(config)
            # a question that Ctrl-C cuts short is no error to tell of
            logging.getLogger("uvicorn.error").addFilter(lambda _: not serving.should_exit)

            def watch() -> None:
                while not serving.should_exit:
                    time.sleep(LOOK_S)
                    serving.should_exit |= server.is_left

            threading.Thread(target=watch, daemon=True).start()
            try:
                serving.run(sockets=[listening])
            except KeyboardInterrupt:
                if not lock.refusal:
                    _leave(server.folder.queue)
                raise
            finally:
                server.close()
                lock.release()


def _copied(name: str) -> Path:
    """A bundled scene in the current folder, with the files that it names; one that is there already stays as it is."""
    from tol3d.kinds import all_kinds
    from tol3d.scene.collection import copy_scene

    path = Path(f"{name}.yaml")
    if path.exists():
        tell(f"{path}: is here already, and is opened as it is")
        return path
    for copy in copy_scene(name, Path(), all_kinds()):
        tell(f"{copy}: copied here")
    return path


def _leave(jobs: "Jobs") -> None:
    """Say what goes on when the app ends; at a terminal it is asked for, and without an answer it goes on."""
    working = sorted(jobs.working, key=lambda job: job.state != "running")
    if not working:
        return
    first, others = working[0], len(working) - 1
    done = f" ({first.done} of {first.of})" if first.of else ""
    words = f"{first.kind.replace('_', '-')} of {first.scene} goes on{done}"
    words += f", and {others} more wait{'s' if others == 1 else ''}" if others else ""
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        tell(f"{words}; the next tol3d app on this folder shows it")
        return
    try:
        stays = typer.confirm(f"{words}: leave it running?", default=True)
    except (typer.Abort, KeyboardInterrupt):
        stays = True
    if stays:
        tell("it goes on; the next tol3d app on this folder shows it")
        return
    for job in reversed(working):  # none begins when the one before it ends
        jobs.cancel(job.id)
    tell("cancelled; what is finished is kept, and the next tol3d app on this folder can resume it")


def _opener(folder: Path, address: str) -> Path:
    """A page for the user alone that leads to the app: a browser's command line, which others see, holds no token."""
    page = folder / "page.html"
    page.touch(stat.S_IRUSR | stat.S_IWUSR)
    page.write_text(
        f'<!doctype html><meta charset="utf-8"><meta http-equiv="refresh" content="0; url={address}">'
        f'<a href="{address}">tol3d</a>'
    )
    return page
