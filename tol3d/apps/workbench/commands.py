"""Command of the app."""

import socket
import stat
import tempfile
import threading
import time
import webbrowser
from pathlib import Path
from typing import Annotated, Any, Final

import typer

from tol3d.cli.arguments import RunBuilders, TrustParts
from tol3d.cli.console import out_console, warn
from tol3d.errors import InputError

LOOK_S: Final = 60.0  # s; how often is looked whether anybody is there


def app(
    place: Annotated[Path, typer.Argument(metavar="[SCENE | FOLDER]", help="A scene, or a folder of scenes.")] = Path(),
    port: Annotated[int, typer.Option(min=0, max=65535, help="Of 127.0.0.1; 0: one that is free.")] = 0,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page in the browser.")] = True,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Open scenes in the browser: the assembly, its distribution, and tolerances to move by hand."""
    import uvicorn

    from tol3d.apps.workbench.place import FolderLock
    from tol3d.apps.workbench.server import Server, application
    from tol3d.apps.workbench.workspace import Workspace

    workspace = Workspace.of(place)
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

            def watch() -> None:
                while not serving.should_exit:
                    time.sleep(LOOK_S)
                    serving.should_exit |= server.is_left

            threading.Thread(target=watch, daemon=True).start()
            try:
                serving.run(sockets=[listening])
            finally:
                server.close()
                lock.release()


def _opener(folder: Path, address: str) -> Path:
    """A page for the user alone that leads to the app: a browser's command line, which others see, holds no token."""
    page = folder / "page.html"
    page.touch(stat.S_IRUSR | stat.S_IWUSR)
    page.write_text(
        f'<!doctype html><meta charset="utf-8"><meta http-equiv="refresh" content="0; url={address}">'
        f'<a href="{address}">tol3d</a>'
    )
    return page
