"""Who may ask the app: this computer's own page alone. One ASGI wrapper around all routes; see docs/app.md.

A page from elsewhere cannot read answers (no CORS header is ever sent), cannot post (origin), cannot reach the server
under another name (host), and does not know the token, which is in no address that is sent, in no log and no cookie.
"""

import hmac
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

TOKEN_HEADER: Final = "x-tol3d-token"
LARGEST_BODY: Final = 1_000_000  # bytes
SHELL: Final = "/"
"""The page itself, without a secret in it: the one address that may be opened from elsewhere, as a page of its own."""
POLICY: Final = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'nonce-{nonce}'; img-src 'self' data:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
HEADERS: Final = (
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cache-control", b"no-store"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"cross-origin-resource-policy", b"same-origin"),
)


@dataclass(frozen=True)
class Guard:
    """Refuses what is not from the app's own page, and adds the headers that browsers hold pages to.

    Args:
        app: the routes.
        port: of the server on 127.0.0.1.
        token: what the page sends with each request.
        nonce: of styles that the editor makes.
    """

    app: ASGIApp
    port: int
    token: str
    nonce: str

    @property
    def origin(self) -> str:
        """Origin of the page."""
        return f"http://127.0.0.1:{self.port}"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """One request; websockets are closed unanswered."""
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
            return
        if scope["type"] != "http":
            await send({"type": "websocket.close", "code": 1008})
            return
        headers = _headers(scope)
        refusal = self._refusal(scope["method"], scope["path"], headers)
        if refusal is not None:
            await PlainTextResponse(refusal[1], refusal[0])(scope, receive, self._with_headers(send))
            return
        await self.app(scope, _limited(receive), self._with_headers(send))

    def _refusal(self, method: str, path: str, headers: dict[str, Sequence[str]]) -> tuple[int, str] | None:
        """Status and words for a request that is not answered; None for one that is."""
        host, site = headers.get("host", ()), headers.get("sec-fetch-site", ("none",))
        if [*host] != [f"127.0.0.1:{self.port}"]:
            return 421, "expected this server's own name"
        opened = path == SHELL and headers.get("sec-fetch-dest", ("document",))[0] == "document"
        if method in ("GET", "HEAD"):
            if site[0] not in ("none", "same-origin") and not opened:
                return 403, "expected a request of the app's own page"
            return None
        if method != "POST":
            return 405, "expected GET or POST"
        if [*headers.get("origin", ())] != [self.origin] or site[0] not in ("none", "same-origin"):
            return 403, "expected a request of the app's own page"
        given = headers.get(TOKEN_HEADER, ())
        if len(given) != 1 or not hmac.compare_digest(given[0].encode(), self.token.encode()):
            return 401, "expected the app's token: open the address that tol3d app printed"
        if headers.get("content-type", ("",))[0].partition(";")[0] != "application/json":
            return 415, "expected JSON"
        length = headers.get("content-length", ("0",))[0]
        if not length.isdecimal() or int(length) > LARGEST_BODY:
            return 413, "expected at most a megabyte"
        return None

    def _with_headers(self, send: Send) -> Send:
        policy = POLICY.format(nonce=self.nonce).encode()

        async def with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                known = [(key, value) for key, value in message.get("headers", ()) if key != b"server"]
                stricter = any(key == b"content-security-policy" for key, _ in known)
                own = [] if stricter else [(b"content-security-policy", policy)]
                message = {**message, "headers": [*known, *HEADERS, *own]}
            await send(message)

        return with_headers


class TooLargeError(Exception):
    """A body that goes on beyond what it may have."""


def _limited(receive: Receive) -> Receive:
    """Receive up to the largest body, whatever its header says."""
    got = 0

    async def limited() -> Message:
        nonlocal got
        message = await receive()
        got += len(message.get("body", b""))
        if got > LARGEST_BODY:
            raise TooLargeError
        return message

    return limited


def _headers(scope: dict[str, Any] | Any) -> dict[str, Sequence[str]]:
    found: dict[str, list[str]] = {}
    for key, value in scope["headers"]:
        found.setdefault(key.decode("latin-1").lower(), []).append(value.decode("latin-1"))
    return {key: tuple(values) for key, values in found.items()}
