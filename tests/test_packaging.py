"""Dependencies: every imported package is declared, and no other."""

import re
import sys
import tomllib
from pathlib import Path

from test_architecture import imported

ROOT = Path(__file__).parents[1]
PACKAGES = ("gcs", "idc_controller", "vehicle_sim")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def normal(name):
    return re.sub(r"[-_.]+", "-", name).lower()


def names(requirements):
    return {normal(re.match(r"[\w.-]+", requirement)[0]) for requirement in requirements}


def test_imported_packages_are_the_declared_dependencies():
    modules = {
        name
        for package in PACKAGES
        for path in (ROOT / package).rglob("*.py")
        for name, _ in imported(path.read_text(encoding="utf-8"))
    }
    foreign = modules - set(sys.stdlib_module_names) - set(PACKAGES)
    foreign -= {"pytest", "pydantic_core"}  # the plugin is loaded by pytest alone; the core is a part of pydantic
    # Each of them is named after its module.
    assert {normal(module) for module in foreign} == names(PROJECT["dependencies"])


def test_all_dependencies_are_pinned():
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    pins = [line for line in lines if line and not line.startswith("#")]
    assert all(re.fullmatch(r"[\w.-]+==[\w.]+", pin) for pin in pins)
    assert names(pins) >= names(PROJECT["dependencies"]) | names(PROJECT["optional-dependencies"]["dev"])
