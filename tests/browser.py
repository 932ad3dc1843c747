"""A headless Chromium that opens pages, driven through its debugging pipe."""

import base64
import io
import json
import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
PATIENCE = 60.0  # s


class PageLeftError(AssertionError):
    """The page that was asked is not there any more: another is being opened."""


class Page:
    """A page as it is shown; `told` is what the console said, `asked` what was requested."""

    def __init__(self, send: int, receive: int) -> None:
        self._send, self._receive, self._rest, self._number = send, receive, b"", 0
        self.session: str | None = None
        self.told: list[str] = []
        self.asked: list[str] = []

    def call(self, method: str, **params: Any) -> Any:
        """Answer of the browser."""
        self._number += 1
        message: dict[str, Any] = {"id": self._number, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        os.write(self._send, json.dumps(message).encode() + b"\0")
        while True:
            found = self._next()
            if found.get("id") == self._number:
                if "navigated" in str(found.get("error", "")):
                    raise PageLeftError
                assert "error" not in found, f"{method}: {found['error']}"
                return found["result"]

    def _next(self) -> dict[str, Any]:
        until = time.monotonic() + PATIENCE
        while b"\0" not in self._rest:
            assert time.monotonic() < until, "the browser does not answer"
            self._rest += os.read(self._receive, 1 << 20)
        text, _, self._rest = self._rest.partition(b"\0")
        found: dict[str, Any] = json.loads(text)
        if found.get("method") in ("Runtime.consoleAPICalled", "Runtime.exceptionThrown", "Log.entryAdded"):
            self.told.append(json.dumps(found["params"]))
        if found.get("method") == "Network.requestWillBeSent":
            self.asked.append(found["params"]["request"]["url"])
        return found

    def open(self, place: Path | str, width: int = 1400, height: int = 1000, *, dark: bool = False) -> None:
        """Show a file, or the page of an address."""
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.call("Emulation.setEmulatedMedia", features=[scheme])
        self.call("Page.navigate", url=place if isinstance(place, str) else place.resolve().as_uri())
        self.wait("document.readyState === 'complete'")

    def ask(self, expression: str) -> Any:
        """The value of an expression of JavaScript."""
        found = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def wait(self, condition: str) -> float:
        """Wait until something is so, on the next page too; how long that took [s]."""
        began = time.monotonic()
        while not self._so(condition):
            assert time.monotonic() - began < PATIENCE, f"never: {condition}"
            time.sleep(0.05)
        return time.monotonic() - began

    def _so(self, condition: str) -> bool:
        with suppress(PageLeftError):
            return bool(self.ask(condition))
        return False

    def picture(self, selector: str) -> np.ndarray:
        """Picture of an element (height, width, 3)."""
        element = f"document.querySelector({json.dumps(selector)})"
        self.ask(f"{element}.scrollIntoView({{block: 'center'}})")
        box = self.ask(f"(b => [b.x + scrollX, b.y + scrollY, b.width, b.height])({element}.getBoundingClientRect())")
        clip = dict(zip(("x", "y", "width", "height"), box, strict=True)) | {"scale": 1}
        found = self.call("Page.captureScreenshot", format="png", clip=clip, captureBeyondViewport=True)
        with Image.open(io.BytesIO(base64.b64decode(found["data"]))) as drawn:
            return np.asarray(drawn.convert("RGB"), dtype=np.float64)

    def pdf(self) -> bytes:
        """The page as it is printed."""
        return base64.b64decode(self.call("Page.printToPDF", printBackground=True)["data"])


@contextmanager
def browser() -> Iterator[Page]:
    """Within it a page to open files in.

    Raises:
        AssertionError: there is no Chromium: `apt-get install chromium`.
    """
    path = next((found for name in BROWSERS if (found := shutil.which(name))), None)
    assert path, "expected a Chromium to look at pages with (Debian: apt-get install chromium)"
    (to_read, send), (receive, to_write) = os.pipe(), os.pipe()
    own = {3: to_read, 4: to_write}
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        command = [
            path,
            "--headless=new",
            "--no-sandbox",
            "--remote-debugging-pipe",
            "--use-gl=angle",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
            "--disable-dev-shm-usage",
            "--no-first-run",
            "--disable-background-networking",
            "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
            f"--user-data-dir={profile}",
            "about:blank",
        ]
        shell = f"exec {' '.join(json.dumps(word) for word in command)} 3<&{own[3]} 4>&{own[4]} 2>/dev/null"
        process = subprocess.Popen(["bash", "-c", shell], pass_fds=list(own.values()))
        os.close(to_read)
        os.close(to_write)
        try:
            page = Page(send, receive)
            target = page.call("Target.createTarget", url="about:blank")["targetId"]
            page.session = page.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
            for domain in ("Page", "Runtime", "Log", "Network"):
                page.call(f"{domain}.enable")
            yield page
        finally:
            process.kill()
            process.wait()
            os.close(send)
            os.close(receive)
