"""Write NOTICE: the licence of everything that is installed with the project, from the metadata of the packages.

python tests/packaging/notice.py > NOTICE
"""

import json
import re
from importlib import metadata
from pathlib import Path

ROOT = Path(__file__).parents[2]
LOCKS = ROOT / "constraints.txt", ROOT / "tests" / "packaging" / "mavproxy.txt"
PAGE = ROOT / "tests" / "packaging" / "page" / "package.json"
ELSEWHERE = {"cmeel-qhull": "Qhull", "cycler": "BSD-3-Clause", "kiwisolver": "BSD-3-Clause", "pymavlink": "LGPL-3.0"}
"""Licences whose names stand in the text of the licence, not among the metadata."""
HEAD = """\
cooplift
Copyright: see the history of its source; licensed under the Apache License, Version 2.0 (LICENSE).

It uses the packages below, which are installed beside it, unchanged, from their own distributions. Each is under the
licence that it states itself; the text is in its folder *.dist-info. Versions are those of constraints.txt and, of
MAVProxy and pyserial, which only tests need, of tests/packaging/mavproxy.txt.
Written by `make docs`.
"""


def normal(name: str) -> str:
    """Return a package's name as indices compare names."""
    return re.sub(r"[-_.]+", "-", name).lower()


def locked() -> dict[str, str]:
    """Return the version of every package of the lock files."""
    texts = [lock.read_text(encoding="utf-8") for lock in LOCKS]
    pins = [pin for text in texts for pin in re.findall(r"^([\w.-]+)==([\w.]+)", text, re.MULTILINE)]
    return {normal(name): version for name, version in pins}


def licence_of(name: str) -> str:
    """Return the licence of an installed package: expression, or classifiers, or the first line of its text."""
    about = metadata.metadata(name)
    if name in ELSEWHERE:
        return ELSEWHERE[name]
    if expression := about.get("License-Expression"):
        return expression
    classifiers = [line.split(" :: ") for line in about.get_all("Classifier") or () if line.startswith("License ::")]
    named = [parts[-1] for parts in classifiers if parts[-1] != "OSI Approved"]
    text = (about.get("License") or "").strip().splitlines()
    return "; ".join(named) or (text[0] if text else "not stated")


INSIDE = """
imageio-ffmpeg (extra film) brings the program ffmpeg, built with x264 under the GPL 3: gcs film runs it as a program of
its own, and nothing of it is distributed with cooplift.

gcs/view/page.bundle.js, which report pages hold, contains these, minified, with the text of their licences:
"""


def notice() -> str:
    """Return the content of NOTICE."""
    rows = [f"{name} {version}: {licence_of(name)}" for name, version in sorted(locked().items())]
    inside = [f"{name} {version} (MIT)" for name, version in json.loads(PAGE.read_text())["dependencies"].items()]
    return HEAD + "\n" + "\n".join(rows) + "\n" + INSIDE + "\n".join(inside) + "\n"


if __name__ == "__main__":
    print(notice(), end="")
