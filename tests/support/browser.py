"""Chromium for tests: skips where there is none; keys and pictures."""

import os

import pytest

from gcs.view import browser

REQUIRED = "COOPLIFT_REQUIRE_BROWSER"
"""Environment variable: 1 makes a missing browser a failure, not a reason to skip."""
_KEYS = {" ": "Space", "+": "Equal", "-": "Minus"}


def browser_path():
    """The path of Chromium; skips the test where there is none."""
    found = browser.find_browser()
    if found is None:
        say = pytest.fail if os.environ.get(REQUIRED) == "1" else pytest.skip
        say("no Chromium on this machine (Debian: apt-get install chromium)")
    return found


class Browser(browser.Browser):
    """One tab of the installed Chromium."""

    def __init__(self, profile):
        super().__init__(browser_path(), profile)

    def press(self, key):
        """Press and release a key."""
        for kind in ("rawKeyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=_KEYS.get(key, key))

    def screenshot(self, path, whole=False):
        """Save what is shown, or the whole page, as a PNG file."""
        path.write_bytes(self.picture(format="png", captureBeyondViewport=whole))
