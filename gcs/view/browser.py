"""Chromium without a screen, driven by the DevTools protocol over a pipe: no driver, no further package."""

import base64
import json
import os
import select
import shutil
import signal
import subprocess
import time
from contextlib import suppress
from pathlib import Path
from typing import Any, Self

from gcs.errors import GcsError, UnusableInput

_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
_PATIENCE = 60.0  # s for an answer, on a machine with other work


def find_browser() -> str:
    """Return the path of an installed Chromium. Raises :class:`UnusableInput` where there is none."""
    found = next(filter(None, map(shutil.which, _NAMES)), None)
    if found is None:
        raise UnusableInput("no Chromium or Chrome is installed (Debian, Ubuntu: apt-get install chromium)")
    return found


class Browser:
    """One tab of the installed Chromium; a context manager that ends the program.

    ``profile`` is a folder that it may fill. Raises :class:`UnusableInput` where none is installed, and
    :class:`GcsError` where it fails or does not answer.
    """

    def __init__(self, profile: Path) -> None:
        self.errors: list[str] = []
        """Errors of the console and uncaught exceptions, since the last page was opened."""
        arguments = [
            find_browser(), "--headless", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
            "--disable-gpu",  # of the page around the canvas, which costs less without
            "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
            "--disable-sync", "--disable-extensions", "--hide-scrollbars", "--remote-debugging-pipe",
            f"--user-data-dir={profile}", "about:blank",
        ]  # fmt: skip
        if os.geteuid() == 0:  # for whom Chromium has none
            arguments.insert(1, "--no-sandbox")
        to_browser, self._commands = os.pipe()
        self._answers, from_browser = os.pipe()
        # The browser reads commands from descriptor 3 and answers on 4.
        shell = f'exec "$@" 3<&{to_browser} 4>&{from_browser}'
        # In a session of its own: an interrupt from the keyboard reaches only this program, which then ends it.
        self._process = subprocess.Popen(
            ["bash", "-c", shell, "bash", *arguments], pass_fds=(to_browser, from_browser),
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
        )  # fmt: skip
        os.close(to_browser)
        os.close(from_browser)
        self._number, self._buffer = 0, b""
        self._session: str | None = None
        try:
            self._attach()
        except BaseException:
            self._end()
            raise

    def _attach(self) -> None:
        targets = self.call("Target.getTargets")["targetInfos"]
        tab = next(target["targetId"] for target in targets if target["type"] == "page")
        self._session = self.call("Target.attachToTarget", targetId=tab, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Return the result of a command of the protocol."""
        self._number += 1
        message: dict[str, Any] = {"id": self._number, "method": method, "params": parameters}
        if self._session is not None:
            message["sessionId"] = self._session
        try:
            os.write(self._commands, json.dumps(message).encode() + b"\0")
        except BrokenPipeError:
            raise GcsError("Chromium has ended") from None
        while (answer := self._next()).get("id") != self._number:
            pass
        if "error" in answer:
            raise GcsError(f"Chromium: {method}: {answer['error']['message']}")
        result: dict[str, Any] = answer["result"]
        return result

    def _next(self) -> dict[str, Any]:
        while b"\0" not in self._buffer:
            if not select.select([self._answers], [], [], _PATIENCE)[0]:
                raise GcsError("Chromium does not answer")
            received = os.read(self._answers, 1 << 20)
            if not received:
                raise GcsError("Chromium has ended")
            self._buffer += received
        text, _, self._buffer = self._buffer.partition(b"\0")
        message: dict[str, Any] = json.loads(text)
        details = message.get("params", {})
        match message.get("method"):
            case "Runtime.exceptionThrown":
                thrown = details["exceptionDetails"]
                self.errors.append(thrown.get("exception", {}).get("description", thrown["text"]))
            case "Runtime.consoleAPICalled" if details["type"] in ("error", "warning", "assert"):
                self.errors.append(" ".join(str(a.get("value", a.get("description"))) for a in details["args"]))
            case "Log.entryAdded" if details["entry"]["level"] == "error":
                self.errors.append(details["entry"]["text"])
        return message

    def open(self, page: Path | str, width: int = 1280, height: int = 800) -> None:
        """Open a file, or an address, in a window of that size (CSS pixels), and wait until its report is shown."""
        self.errors.clear()
        self.size(width, height)
        self.call("Page.navigate", url=page if isinstance(page, str) else page.resolve().as_uri())
        self.wait("window.report !== undefined || document.querySelector('.failed') !== null")

    def size(self, width: int, height: int) -> None:
        """Make the window so large (CSS pixels)."""
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def value(self, script: str) -> Any:
        """Return the value of an expression of JavaScript, or of its promise."""
        result = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            thrown = result["exceptionDetails"]
            raise GcsError(f"Chromium: {thrown.get('exception', {}).get('description', thrown['text'])}")
        return result["result"].get("value")

    def wait(self, condition: str) -> None:
        """Wait until an expression is true."""
        end = time.monotonic() + _PATIENCE
        while not self.value(condition):
            if time.monotonic() > end:
                raise GcsError(f"Chromium: {condition} does not become true")
            self.value("new Promise((resolve) => setTimeout(resolve, 50))")

    def frame(self) -> None:
        """Wait until two frames are drawn."""
        self.value("new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(() => resolve(0))))")

    def picture(self, **parameters: Any) -> bytes:
        """Return what is shown as the content of a picture file; parameters are those of Page.captureScreenshot."""
        return base64.b64decode(self.call("Page.captureScreenshot", **parameters)["data"])

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._end()

    def _end(self) -> None:
        try:
            self._session = None
            self.call("Browser.close")
            self._process.wait(10)
        except (OSError, GcsError, subprocess.TimeoutExpired):
            with suppress(ProcessLookupError):
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()
        os.close(self._commands)
        os.close(self._answers)
