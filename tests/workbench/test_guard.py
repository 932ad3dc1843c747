"""The app answers its own page alone, says nothing that helps another, and follows nothing out of its folder."""

import asyncio
import json
import shutil
import signal
import urllib.error
import urllib.request
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from html.parser import HTMLParser
from pathlib import Path
from threading import Event
from typing import Any

import pytest
from app_folders import EVIL, HOSTILE, ORDER, left_attempt, posted, started
from places import SPUR_PAIR

from tol3d import InputError
from tol3d.apps.workbench import server as server_module
from tol3d.apps.workbench.attempt import ANSWER, NUMBERS, Progress
from tol3d.apps.workbench.guard import LARGEST_BODY, Guard
from tol3d.apps.workbench.place import FolderLock
from tol3d.apps.workbench.server import ASKED, FILES, Server, application
from tol3d.apps.workbench.workspace import Workspace

PORT = 4711
HOST, ORIGIN, TOKEN = f"127.0.0.1:{PORT}", f"http://127.0.0.1:{PORT}", "of this test"
OURS = {
    "host": HOST,
    "origin": ORIGIN,
    "sec-fetch-site": "same-origin",
    "x-tol3d-token": TOKEN,
    "content-type": "application/json",
}
"""Headers of the page's own question."""
OPENED = {"host": HOST, "sec-fetch-site": "none", "sec-fetch-dest": "document"}
"""Headers of an address that the user opened."""


@dataclass(frozen=True)
class Reply:
    """The answer; the status of a websocket is None."""

    status: int | None
    headers: list[tuple[str, str]]
    body: bytes


def reply(
    app: Guard, method: str, path: str, headers: Sequence[tuple[str, str]], body: Sequence[bytes] = (b"",)
) -> Reply:
    """Answer to one request, whose body comes in pieces."""
    scope = {
        "type": "http",
        "asgi": {"version": "3.0"},
        "http_version": "1.1",
        "method": method,
        "scheme": "http",
        "path": path,
        "raw_path": path.encode(),
        "query_string": b"",
        "root_path": "",
        "headers": [(key.encode("latin-1"), value.encode("latin-1")) for key, value in headers],
        "client": ("127.0.0.1", 1),
        "server": ("127.0.0.1", PORT),
    }
    pieces = [{"type": "http.request", "body": own, "more_body": k < len(body) - 1} for k, own in enumerate(body)]
    return _answered(app, scope, pieces)


def _answered(app: Guard, scope: dict[str, Any], pieces: list[dict[str, Any]]) -> Reply:
    sent: list[dict[str, Any]] = []
    coming = iter(pieces)

    async def receive() -> dict[str, Any]:
        return next(coming, {"type": "http.disconnect"})

    async def send(message: Any) -> None:
        sent.append(message)

    asyncio.run(app(scope, receive, send))
    (start,) = [own for own in sent if own["type"] == "http.response.start"] or [{}]
    headers = [(key.decode("latin-1"), value.decode("latin-1")) for key, value in start.get("headers", ())]
    return Reply(start.get("status"), headers, b"".join(own.get("body", b"") for own in sent))


def asked(app: Guard, name: str, **words: object) -> tuple[int | None, Any]:
    """Status and data of the page's own question."""
    found = reply(app, "POST", f"/api/{name}", [*OURS.items()], [json.dumps(words).encode()])
    return found.status, json.loads(found.body)


@contextmanager
def opened(folder: Path) -> Iterator[tuple[Server, Guard]]:
    """The app on a folder."""
    with FolderLock(folder) as lock:
        server = Server(Workspace.of(folder), lock)
        try:
            yield server, application(server, PORT, TOKEN)
        finally:
            server.close()


@pytest.fixture(scope="module")
def app(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Guard]:
    folder = tmp_path_factory.mktemp("folder")
    shutil.copy(SPUR_PAIR, folder)
    with opened(folder) as (_, guarded):
        yield guarded


def without(*names: str, **others: str) -> list[tuple[str, str]]:
    """The page's own headers but for some."""
    changed = {key.replace("_", "-"): value for key, value in others.items()}
    return [(key, value) for key, value in {**OURS, **changed}.items() if key not in names]


QUESTIONS = [
    ("its own", without(), 200),
    ("its own, of a browser that says less", without("sec-fetch-site"), 200),
    ("its own, with a charset", without(content_type="application/json; charset=utf-8"), 200),
    ("no token", without("x-tol3d-token"), 401),
    ("wrong token", without(x_tol3d_token=TOKEN[:-1]), 401),
    ("a token that is no ASCII", without(x_tol3d_token="é"), 401),
    ("two tokens", [*without(), ("x-tol3d-token", TOKEN)], 401),
    ("foreign host", without(host="evil.example"), 421),
    ("foreign host, our port", without(host=f"evil.example:{PORT}"), 421),
    ("localhost", without(host=f"localhost:{PORT}"), 421),
    ("another port", without(host=f"127.0.0.1:{PORT + 1}"), 421),
    ("no port", without(host="127.0.0.1"), 421),
    ("no host", without("host"), 421),
    ("two hosts", [*without(), ("host", HOST)], 421),
    ("two hosts, one foreign", [("host", "evil.example"), *without()], 421),
    ("no origin", without("origin"), 403),
    ("two origins", [*without(), ("origin", ORIGIN)], 403),
    *((f"origin {own}", without(origin=own), 403) for own in (
        "null", "http://evil.example", f"https://127.0.0.1:{PORT}", f"http://localhost:{PORT}",
        f"http://127.0.0.1:{PORT + 1}", f"{ORIGIN}.evil.example",
    )),
    *((f"site {own}", without(sec_fetch_site=own), 403) for own in ("cross-site", "same-site")),
    *((f"type {own}", without(content_type=own), 415) for own in (
        "text/plain", "application/x-www-form-urlencoded", "multipart/form-data", "",
    )),
    ("no type", without("content-type"), 415),
    ("a long body", without(content_length=str(LARGEST_BODY + 1)), 413),
    ("no length", without(content_length="-1"), 413),
]  # fmt: skip


@pytest.mark.parametrize(("headers", "status"), [own[1:] for own in QUESTIONS], ids=[own[0] for own in QUESTIONS])
def test_only_the_own_page_is_answered(headers: list[tuple[str, str]], status: int, app: Guard) -> None:
    found = reply(app, "POST", "/api/folder", headers, [b"{}"])
    assert found.status == status
    assert (b"spur_pair" in found.body) == (status == 200)
    _strict(found)


PATHS = [
    *(("GET", "/", OPENED | {"sec-fetch-site": own}, 200) for own in ("none", "same-origin", "cross-site")),
    ("GET", "/", {"host": HOST}, 200),
    ("GET", "/", OPENED | {"sec-fetch-site": "cross-site", "sec-fetch-dest": "iframe"}, 403),
    ("GET", "/", OPENED | {"host": f"localhost:{PORT}"}, 421),
    *(("GET", f"/{name}", {"host": HOST}, 200) for name in FILES),
    ("HEAD", "/app.js", OPENED, 200),
    *(("GET", "/app.js", OPENED | {"sec-fetch-site": own}, 403) for own in ("cross-site", "same-site")),
    *(("GET", f"/api/{name}", OURS, 405) for name in ASKED),
    *((method, "/api/folder", OURS, 405) for method in ("PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "CONNECT")),
    *((method, "/", OURS, 405) for method in ("OPTIONS", "POST")),
    *(("POST", path, OURS, 404) for path in ("/api/none", "/api/__init__", "/api/close", "/api/session", "/api/")),
    *(("GET", path, OPENED, 404) for path in (
        "/none", "/index.html", "/spur_pair.yaml", "/../spur_pair.yaml", "/../../etc/passwd", "/%2e%2e/spur_pair.yaml",
        "//etc/passwd", "/app.js/../spur_pair.yaml", "/report/", "/report/none", "/report/../app.js", "/report/..",
        "/api/../app.js", "/.tol3d/app/lock",
    )),
]  # fmt: skip


@pytest.mark.parametrize(("method", "path", "headers", "status"), PATHS)
def test_only_the_page_its_files_and_its_questions_are_there(
    method: str, path: str, headers: dict[str, str], status: int, app: Guard
) -> None:
    found = reply(app, method, path, [*headers.items()], [b"{}"])
    assert found.status == status
    _strict(found)


def _strict(found: Reply) -> None:
    """Headers of every answer, for the browser that shows it."""
    names = [key for key, _ in found.headers]
    assert len({*names}) == len(names)
    told = dict(found.headers)
    assert told["content-security-policy"].startswith("default-src 'none'; script-src 'self'; style-src 'self' 'nonce-")
    assert "frame-ancestors 'none'" in told["content-security-policy"]
    assert "unsafe" not in told["content-security-policy"]
    assert (told["x-content-type-options"], told["cache-control"]) == ("nosniff", "no-store")
    assert told["referrer-policy"] == "no-referrer"
    assert told["cross-origin-opener-policy"] == told["cross-origin-resource-policy"] == "same-origin"
    assert not [name for name in names if name.startswith("access-control") or name in ("server", "set-cookie")]
    assert TOKEN.encode() not in found.body


@pytest.mark.parametrize("length", [None, "2"])
def test_a_body_is_cut_off_whatever_its_header_says(length: str | None, app: Guard) -> None:
    headers = without(**({} if length is None else {"content_length": length}))
    piece = b" " * (LARGEST_BODY // 2)
    assert reply(app, "POST", "/api/folder", headers, [b"{}", piece, piece[2:]]).status == 200
    found = reply(app, "POST", "/api/folder", headers, [b"{}", piece, piece])
    assert found.status == 413
    _strict(found)


@pytest.mark.parametrize("body", [b"", b"{", b"[]", b"1", b"\xff", b"[" * 200_000, b'{"a":' * 100_000])
def test_a_body_that_is_no_object_is_refused(body: bytes, app: Guard) -> None:
    found = reply(app, "POST", "/api/folder", without(), [body])
    assert (found.status, json.loads(found.body)) == (400, {"error": "expected a JSON object"})


PAIR = {"scene": "spur_pair.yaml"}


@pytest.mark.parametrize("words", [{}, {"scene": None}, {"scene": 3, "text": 4}, {"scene": ["spur_pair.yaml"]}])
@pytest.mark.parametrize("name", ASKED)
def test_a_question_with_other_words_than_the_page_s_has_words_for_an_answer(
    name: str, words: dict[str, object], app: Guard
) -> None:
    status, found = asked(app, name, **words)
    assert (status == 200) == (name in ("folder", "jobs") or (name == "changed" and "scene" in words))
    assert status in (200, 400, 422)
    assert isinstance(found.get("error", ""), str)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        *((name, {"now": now}) for name in ("card", "estimate", "notes", "keep") for now in (3, [1], "x", {"none": 1})),
        *(("notes", {"beside": beside}) for beside in (3, [3], {"a": 1})),
        *(("view", {"trial": trial}) for trial in (-1, 10**9, "x", [1])),
        *(("view", {"builds": builds}) for builds in (3, None)),
        *(
            (name, {"id": own})
            for name in ("cancel", "resume", "report", "delete", "answer", "numbers")
            for own in ("", "../..", "0001", 7, None)
        ),
        *(("report", {"run": run}) for run in ("../..", "..", "/etc", "none", "spur_pair.yaml", 7, ["x"])),
        *((name, {"kind": kind}) for name in ("analyse", "forms") for kind in (None, "", "report", "../effects", 7)),
        *(("analyse", {"kind": "effects", "fields": fields}) for fields in (3, ["x"], "x", [["base"]])),
        ("start", {"fields": ["trials"]}),
        *(("view", {"factor": factor}) for factor in (0, 7.0, 1e308, "x", [1])),
        *(("view", {"positions": positions}) for positions in (3, [1], "x", {"gear pair driver position": "x"})),
        *(("view", {"known": known}) for known in (3, [1], "x", {"meshes": "x"})),
        ("view", {"world": "none"}),
        ("keep", {"now": {"centre distance": "x2"}, "write": True, "digest": None}),
        ("save", {"text": "\ud800", "digest": ""}),
        ("save", {"text": None, "digest": ["x"]}),
        ("card", {"measure": ["x"]}),
    ],
)
def test_words_of_another_kind_are_refused(name: str, words: dict[str, object], app: Guard) -> None:
    status, found = asked(app, name, **PAIR, **words)
    if (name, words) == ("notes", {"now": {"none": 1}}):
        assert status == 200, "no more than noted"
    else:
        assert status in (400, 409, 422)
        assert found["error"]


def test_no_websocket_is_opened(app: Guard) -> None:
    sent: list[Any] = []

    async def send(message: Any) -> None:
        sent.append(message)

    async def receive() -> Any:
        return {"type": "websocket.connect"}

    headers = [(key.encode(), value.encode()) for key, value in OURS.items()]
    asyncio.run(app({"type": "websocket", "path": "/api/folder", "headers": headers}, receive, send))
    assert [own["type"] for own in sent] == ["websocket.close"]


def test_the_page_holds_no_secret_but_the_nonce_of_its_policy(app: Guard) -> None:
    found = reply(app, "GET", "/", [*OPENED.items()])
    assert app.nonce in found.body.decode()
    assert f"'nonce-{app.nonce}'" in dict(found.headers)["content-security-policy"]
    assert b"NONCE" not in found.body
    elements = _elements(found.body.decode())
    assert all("src" in attributes for own, attributes in elements if own == "script")
    assert not [own for own, attributes in elements if own == "style" or "style" in attributes]


def test_tokens_are_of_256_bits_and_never_the_same(tmp_path: Path) -> None:
    shutil.copy(SPUR_PAIR, tmp_path)
    with opened(tmp_path) as (server, _):
        tokens = {application(server, PORT).token for _ in range(3)}
    assert len(tokens) == 3
    assert {len(own) for own in tokens} == {43}  # 256 bits by 6 a letter


def test_a_report_opens_once_in_a_sandbox_and_not_late(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copy(SPUR_PAIR, tmp_path)
    page = tmp_path / "report.html"
    page.write_text("<p>report</p>")

    class Answers:
        def report(self, words: object) -> Path:
            return page

        def close(self) -> None:
            pass

    with opened(tmp_path) as (server, app):
        server.folder = Answers()  # type: ignore[assignment]
        status, found = asked(app, "report", id="0001")
        assert status == 200
        address = found["address"]
        assert len(address.removeprefix("/report/")) == 43
        assert reply(app, "GET", address, [*(OPENED | {"sec-fetch-site": "cross-site"}).items()]).status == 403
        first = reply(app, "GET", address, [*OPENED.items()])
        assert (first.status, first.body) == (200, b"<p>report</p>")
        policies = [value for key, value in first.headers if key == "content-security-policy"]
        assert policies == ["sandbox allow-scripts"]
        assert dict(first.headers)["cross-origin-resource-policy"] == "same-origin"
        assert reply(app, "GET", address, [*OPENED.items()]).status == 404
        monkeypatch.setattr(server_module, "TICKET_S", -1.0)
        _, late = asked(app, "report", id="0001")
        assert reply(app, "GET", late["address"], [*OPENED.items()]).status == 404
        assert server.tickets == {}


def test_questions_on_the_folder_do_not_wait_until_a_scene_is_evaluated(tmp_path: Path) -> None:
    shutil.copy(SPUR_PAIR, tmp_path)
    evaluated = Event()
    with opened(tmp_path) as (server, app):
        server.thread.submit(evaluated.wait, 60.0)
        try:
            answers = [asked(app, name, **PAIR)[0] for name in ("folder", "changed", "jobs", "runs")]
            assert not evaluated.is_set()
        finally:
            evaluated.set()
    assert answers == [200] * 4


def test_numbers_of_an_answer_are_a_file_and_no_page(tmp_path: Path) -> None:
    shutil.copy(SPUR_PAIR, tmp_path)
    with opened(tmp_path) as (_, app):
        attempt = left_attempt(tmp_path, replace(ORDER, kind="effects"), Progress("done"))
        (attempt.place / ANSWER).touch()
        (attempt.place / NUMBERS).write_text("<script>,1\n", "utf-8")
        _, found = asked(app, "numbers", id="0001")
        got = reply(app, "GET", found["address"], [*OPENED.items()])
        headers = dict(got.headers)
        assert (got.status, got.body) == (200, b"<script>,1\n")
        assert headers["content-type"] == "text/csv; charset=utf-8"
        assert (headers["content-disposition"], headers["x-content-type-options"]) == ("attachment", "nosniff")
        (attempt.place / NUMBERS).unlink()
        (attempt.place / NUMBERS).symlink_to(SPUR_PAIR)
        status, found = asked(app, "numbers", id="0001")
        assert (status, "leads out of" in found["error"]) == (422, True)


@pytest.mark.slow
def test_a_server_that_is_killed_loses_no_what_if_and_ends_in_order_when_it_is_asked(tmp_path: Path) -> None:
    shutil.copy(SPUR_PAIR, tmp_path)
    words = {"scene": SPUR_PAIR.name, "now": {"centre distance": "x2"}, "measure": "lost motion"}

    with started(tmp_path) as (process, origin, token):
        assert posted(origin, token, "notes", words) == {}
        process.kill()
    with started(tmp_path) as (process, origin, token):
        for wrong in (("http://localhost:" + origin.rpartition(":")[2], token), (origin, "x" * 43)):
            with pytest.raises(urllib.error.HTTPError) as error:
                posted(*wrong, "folder", words)
            assert error.value.code in (401, 421)
            error.value.close()
        assert posted(origin, token, "folder", words)["read_only"] == "", "the lock of a killed one is free"
        assert posted(origin, token, "scene", words)["notes"] == {
            "now": words["now"],
            "past": [],
            "beside": [],
            "measure": "lost motion",
        }
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 130
        assert process.stdout is not None
        assert process.stdout.read() == "Ctrl-C ends it\nstopped\n"
    assert [*tmp_path.glob("*.yaml")] == [tmp_path / SPUR_PAIR.name]
    assert (tmp_path / SPUR_PAIR.name).read_bytes() == SPUR_PAIR.read_bytes()


# the folder ---------------------------------------------------------------------------------------


def test_links_out_of_the_folder_are_no_scenes(tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    (folder / "below").mkdir(parents=True)
    outside = tmp_path / "secret.yaml"
    shutil.copy(SPUR_PAIR, folder)
    for own in (outside, folder / "below" / "low.yaml"):
        shutil.copy(SPUR_PAIR, own)
    (folder / "out.yaml").symlink_to(outside)
    (folder / "up.yaml").symlink_to("../secret.yaml")
    (folder / "lost.yaml").symlink_to("nothing")
    (folder / "loop.yaml").symlink_to("loop.yaml")
    (folder / "dir.yaml").mkdir()
    (folder / "again.yaml").symlink_to("spur_pair.yaml")
    with opened(folder) as (_, app):
        _, told = asked(app, "folder")
        assert told["scenes"] == ["again.yaml", "spur_pair.yaml"]
        for name in (
            "out.yaml",
            "up.yaml",
            "../secret.yaml",
            str(outside),
            "below/low.yaml",
            "",
            ".",
            "spur_pair.yaml\0",
        ):
            for question in ("scene", "save", "notes"):
                status, found = asked(app, question, scene=name, text="", digest="")
                assert (status, "expected a scene of folder" in found["error"]) == (422, True)


@pytest.mark.parametrize("link", [".tol3d", ".tol3d/app", ".tol3d/app/lock"])
def test_a_place_of_the_app_that_leads_out_is_refused(link: str, tmp_path: Path) -> None:
    folder, outside = tmp_path / "folder", tmp_path / "outside"
    outside.mkdir()
    (folder / link).parent.mkdir(parents=True)
    shutil.copy(SPUR_PAIR, folder)
    (folder / link).symlink_to(outside)
    with pytest.raises(InputError, match=r"out of|got a link"):
        FolderLock(folder)
    if not link.endswith("lock"):
        with pytest.raises(InputError, match="leads out of"):
            _ = Workspace.of(folder).notes_folder
    assert [*outside.iterdir()] == []


def test_notes_that_are_a_link_are_replaced_and_not_followed(tmp_path: Path) -> None:
    folder, outside = tmp_path / "folder", tmp_path / "outside.json"
    folder.mkdir()
    outside.write_text("untouched")
    shutil.copy(SPUR_PAIR, folder)
    with opened(folder) as (_, app):
        (folder / ".tol3d" / "app" / "spur_pair.yaml.json").symlink_to(outside)
        assert asked(app, "notes", scene="spur_pair.yaml", now={"centre distance": "x2"})[0] == 200
    assert outside.read_text() == "untouched"


class _Tags(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None]]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))


def _elements(html: str) -> list[tuple[str, dict[str, str | None]]]:
    parser = _Tags()
    parser.feed(html)
    return parser.found


def test_names_of_a_stranger_s_scene_are_text(tmp_path: Path) -> None:
    (tmp_path / "hostile.yaml").write_text(HOSTILE)
    line, scene = f"{EVIL} tolerance", {"scene": "hostile.yaml"}
    with opened(tmp_path) as (_, app):
        _, first = asked(app, "scene", **scene)
        assert first["problems"] == []
        _, card = asked(app, "card", **scene, now={line: "x1.5"})
        _, estimate = asked(app, "estimate", **scene, now={line: "x1.5"})
        _, sliders = asked(app, "sliders", **scene)
    pieces = [first["tree"], card["answer"], card["chart"], estimate["chart"], sliders["sliders"]]
    every = [own for piece in pieces for own in _elements(piece)]
    assert {"button", "details", "table", "svg", "input"} <= {own for own, _ in every}
    assert not [own for own, _ in every if own in ("img", "script", "iframe", "object", "a")]
    assert not [key for _, attributes in every for key in attributes if key.startswith("on")]
    named = [value for _, attributes in every for key, value in attributes.items() if key in ("data-name", "data-line")]
    assert {f"{EVIL} part", line} <= {*named}
