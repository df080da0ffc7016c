"""Chromium for tests: skips where there is none; keys and pictures."""

import os

import pytest

from gcs.errors import UnusableInput
from gcs.view import browser

REQUIRED = "COOPLIFT_REQUIRE_BROWSER"
"""Environment variable: 1 makes a missing browser a failure, not a reason to skip."""
_KEYS = {" ": "Space", "+": "Equal", "-": "Minus"}


def need_browser():
    """Skip the test where no Chromium is installed, or fail."""
    try:
        browser.find_browser()
    except UnusableInput as error:
        say = pytest.fail if os.environ.get(REQUIRED) == "1" else pytest.skip
        say(str(error))


class Browser(browser.Browser):
    """One tab of the installed Chromium."""

    def __init__(self, profile):
        need_browser()
        super().__init__(profile)

    def press(self, key):
        """Press and release a key."""
        for kind in ("rawKeyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=_KEYS.get(key, key))

    def screenshot(self, path, whole=False):
        """Save what is shown, or the whole page, as a PNG file."""
        path.write_bytes(self.picture(format="png", captureBeyondViewport=whole))
