"""Requests of the app's page: static files, and questions as JSON. It loads what answers them when the first is asked."""

import asyncio
import json
import secrets
from collections.abc import Awaitable, Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from importlib import import_module, resources
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, Response
from starlette.routing import Route

from tol3d.apps.workbench.guard import LARGEST_BODY, Guard, TooLarge
from tol3d.apps.workbench.workspace import Workspace
from tol3d.errors import InputError

if TYPE_CHECKING:
    from tol3d.apps.workbench.questions import Questions

QUESTIONS: Final = "tol3d.apps.workbench.questions"  # loads analyses and scipy: seconds
ASKED: Final = ("folder", "scene", "card", "estimate", "sliders", "notes", "check", "keep", "save", "changed")
TYPES: Final = {".js": "text/javascript", ".css": "text/css"}
PAGE: Final = "tol3d.apps.workbench.page"
REPORT: Final = "tol3d.report.html"
FILES: Final = {"app.js": PAGE, "app.css": PAGE, "editor.js": PAGE, "style.css": REPORT, "viewer.js": REPORT}
STALE: Final = 409


@dataclass(eq=False)
class Server:
    """Answers requests for one workspace.

    Args:
        workspace: the folder.
        trust_parts, run_builders: as `tol3d run` has them.
        read_only: True where another app writes in this folder.
    """

    workspace: Workspace
    trust_parts: bool = False
    run_builders: bool = False
    read_only: bool = False
    thread: ThreadPoolExecutor = field(default_factory=partial(ThreadPoolExecutor, 1, "live"))
    _questions: "Questions | None" = None

    @property
    def questions(self) -> "Questions":
        """What answers; only its own thread asks."""
        if self._questions is None:
            made = import_module(QUESTIONS).Questions
            self._questions = made(self.workspace, self.trust_parts, self.run_builders, self.read_only)
        return self._questions

    def ask(self, name: str, asked: Mapping[str, Any]) -> Mapping[str, Any]:
        """An answer."""
        answer: Mapping[str, Any] = getattr(self.questions, name)(asked)
        return answer

    def close(self) -> None:
        """Let threads end, and remove what was made for the time that it was open."""
        self.thread.shutdown(wait=True, cancel_futures=True)
        if self._questions is not None:
            self._questions.close()


def application(server: Server, port: int, token: str | None = None) -> Guard:
    """All routes, guarded."""
    routes = [Route(f"/api/{name}", _question(server, name), methods=["POST"]) for name in ASKED]
    routes += [Route(f"/{name}", _file(package, name)) for name, package in FILES.items()]
    guard = Guard(Starlette(routes=routes), port, token or secrets.token_urlsafe(32))
    page = resources.files(PAGE).joinpath("index.html").read_text("utf-8").replace("NONCE", guard.nonce)
    routes.append(Route("/", lambda request: HTMLResponse(page)))
    guard.app.routes.append(routes[-1])
    return guard


def _question(server: Server, name: str) -> Callable[[Request], Awaitable[Response]]:
    """A question, asked in the server's thread; errors of a user are its answer."""

    async def route(request: Request) -> Response:
        try:
            asked = json.loads(await request.body())
            if not isinstance(asked, dict):
                raise ValueError
        except TooLarge:
            return JSONResponse({"error": f"expected at most {LARGEST_BODY} bytes"}, 413)
        except ValueError:
            return JSONResponse({"error": "expected a JSON object"}, 400)
        try:
            return JSONResponse(await asyncio.get_running_loop().run_in_executor(server.thread, server.ask, name, asked))
        except InputError as error:
            return JSONResponse({"error": str(error)}, STALE if type(error).__name__ == "Stale" else 422)
        except (KeyError, TypeError, ValueError) as error:
            return JSONResponse({"error": f"expected another request: {error!r}"}, 400)

    return route


def _file(package: str, name: str) -> Callable[[Request], Response]:
    content = resources.files(package).joinpath(name)

    def file(request: Request) -> Response:
        del request
        return Response(content.read_bytes(), media_type=TYPES[Path(name).suffix])

    return file
