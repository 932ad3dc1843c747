"""Requests of the app's page: static files, and questions as JSON. Those on scenes load what answers them."""

import asyncio
import json
import secrets
import time
from collections.abc import Awaitable, Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from importlib import import_module, resources
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Route

from tol3d.apps.workbench.folder_questions import FolderQuestions
from tol3d.apps.workbench.guard import LARGEST_BODY, Guard, TooLargeError
from tol3d.apps.workbench.place import FolderLock
from tol3d.apps.workbench.workspace import Workspace
from tol3d.errors import InputError

if TYPE_CHECKING:
    from tol3d.apps.workbench.questions import Questions

QUESTIONS: Final = "tol3d.apps.workbench.questions"  # loads analyses and scipy: seconds
OF_SCENES: Final = (
    *("scene", "card", "estimate", "rounded", "sliders", "notes", "check", "keep", "save", "view", "forms", "fit"),
)
OF_FOLDER: Final = (
    *("folder", "changed", "jobs", "start", "analyse", "cancel", "resume", "delete"),
    *("runs", "report", "answer", "numbers"),
)
ASKED: Final = (*OF_SCENES, *OF_FOLDER)
"""Questions; those of the folder do not wait until a scene is evaluated."""
TICKET_S: Final = 60.0
"""Time for which the address of a report or of numbers holds [s]; each opens once."""
LEFT_AFTER_S: Final = 3600.0
"""Time without a request after which the app ends; open pages ask once a minute, hidden ones too [s]."""
SANDBOX: Final = "sandbox allow-scripts"
"""Policy of a report, which may be of a stranger's run: it cannot ask this server for anything."""
TYPES: Final = {".js": "text/javascript", ".css": "text/css", ".html": "text/html", ".csv": "text/csv"}
PAGE: Final = "tol3d.apps.workbench.page"
REPORT: Final = "tol3d.report.html"
SCRIPTS: Final = (
    *(
        "analyses.js",
        "app.js",
        "ask.js",
        "card.js",
        "editor.js",
        "jobs.js",
        "sliders.js",
        "stage.js",
        "stands.js",
        "text.js",
    ),
)
FILES: Final = {**dict.fromkeys((*SCRIPTS, "app.css", "jobs.css"), PAGE), "style.css": REPORT, "viewer.js": REPORT}
STALE: Final = 409


@dataclass(eq=False)
class Server:
    """Answers requests for one workspace.

    Args:
        workspace: the folder.
        lock: the right to write in it.
        trust_parts, run_builders: as `tol3d run` has them.
    """

    workspace: Workspace
    lock: FolderLock
    trust_parts: bool = False
    run_builders: bool = False
    tickets: dict[str, tuple[float, Path]] = field(default_factory=dict)
    thread: ThreadPoolExecutor = field(default_factory=partial(ThreadPoolExecutor, 1, "live"))
    solids: ThreadPoolExecutor = field(default_factory=partial(ThreadPoolExecutor, 1, "solids"))
    beside: ThreadPoolExecutor = field(default_factory=partial(ThreadPoolExecutor, 1, "folder"))
    asked_at: float = field(default_factory=time.monotonic)
    folder: FolderQuestions = field(init=False)
    _questions: "Questions | None" = None

    def __post_init__(self) -> None:
        self.folder = FolderQuestions(self.workspace, self.lock, self.trust_parts, self.run_builders)

    @property
    def questions(self) -> "Questions":
        """The one that answers; only its own thread asks."""
        if self._questions is None:
            made = import_module(QUESTIONS).Questions
            self._questions = made(self.workspace, self.lock, self.trust_parts, self.run_builders)
        return self._questions

    async def asked(self, name: str, words: Mapping[str, Any]) -> Response:
        """An answer: data as JSON, bytes as they are, a file as an address at which it opens once."""
        loop, self.asked_at = asyncio.get_running_loop(), time.monotonic()
        if name in OF_FOLDER:
            answer: Any = await loop.run_in_executor(self.beside, getattr(self.folder, name), words)
        else:
            answer = await loop.run_in_executor(self.thread, lambda: getattr(self.questions, name)(words))
        if callable(answer):
            answer = await loop.run_in_executor(self.solids, answer)
        if isinstance(answer, bytes):
            return Response(answer, media_type="application/octet-stream")
        if isinstance(answer, Path):
            ticket = secrets.token_urlsafe(32)
            self.tickets[ticket] = (time.monotonic() + TICKET_S, answer)
            return JSONResponse({"address": f"/report/{ticket}"})
        return JSONResponse(answer)

    def file(self, request: Request) -> Response:
        """A file at the address that was made for it."""
        until, path = self.tickets.pop(request.path_params["ticket"], (0.0, Path()))
        if time.monotonic() > until:
            return PlainTextResponse("expected an address that the app has just made: ask for the report again", 404)
        headers = {"content-security-policy": SANDBOX}
        if path.suffix != ".html":
            headers["content-disposition"] = "attachment"
        return Response(path.read_bytes(), media_type=TYPES[path.suffix], headers=headers)

    @property
    def is_left(self) -> bool:
        """True if no page has asked for an hour, and no job is going on."""
        return time.monotonic() - self.asked_at >= LEFT_AFTER_S and not self.folder.queue.working

    def close(self) -> None:
        """Let threads end, and remove what was made for the time that it was open."""
        for own in (self.solids, self.beside, self.thread):
            own.shutdown(wait=True, cancel_futures=True)
        if self._questions is not None:
            self._questions.close()


def application(server: Server, port: int, token: str | None = None) -> Guard:
    """All routes, guarded."""
    routes = [Route(f"/api/{name}", _question(server, name), methods=["POST"]) for name in ASKED]
    routes += [Route(f"/{name}", _file(package, name)) for name, package in FILES.items()]
    routes.append(Route("/report/{ticket}", server.file))
    nonce = secrets.token_urlsafe(16)
    page = resources.files(PAGE).joinpath("index.html").read_text("utf-8").replace("NONCE", nonce)
    routes.append(Route("/", lambda request: HTMLResponse(page)))
    return Guard(Starlette(routes=routes), port, token or secrets.token_urlsafe(32), nonce)


def _question(server: Server, name: str) -> Callable[[Request], Awaitable[Response]]:
    """A question, asked in the server's thread; errors of a user are its answer."""

    async def route(request: Request) -> Response:
        try:
            asked = json.loads(await request.body())
            if not isinstance(asked, dict):
                raise ValueError
        except TooLargeError:
            return JSONResponse({"error": f"expected at most {LARGEST_BODY} bytes"}, 413)
        except (ValueError, RecursionError):  # brackets in brackets, by the thousand
            return JSONResponse({"error": "expected a JSON object"}, 400)
        try:
            return await server.asked(name, asked)
        except InputError as error:
            return JSONResponse({"error": str(error)}, STALE if type(error).__name__ == "StaleError" else 422)
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            return JSONResponse({"error": f"expected another request: {error!r}"}, 400)

    return route


def _file(package: str, name: str) -> Callable[[Request], Response]:
    content = resources.files(package).joinpath(name)

    def file(request: Request) -> Response:
        del request
        return Response(content.read_bytes(), media_type=TYPES[Path(name).suffix])

    return file
