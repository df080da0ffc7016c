"""Dependencies: every imported package is declared, and no other; all are locked, and their licences named."""

import re
import sys
import tomllib
from pathlib import Path

import pytest
from test_architecture import imported, nodes_in

import gcs
import idc_controller
import vehicle_sim
from gcs.app.cli import main

ROOT = Path(__file__).parents[2]
PACKAGES = ("gcs", "idc_controller", "vehicle_sim")
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = PYPROJECT["project"]

EXTRAS = PROJECT["optional-dependencies"]
REQUIRED = [
    *PROJECT["dependencies"],
    *(each for name in ("cluster", "film", "parquet", "suites") for each in EXTRAS[name]),
]
DECLARED = [*REQUIRED, *EXTRAS["ulog"], *EXTRAS["dev"][1:]]
"""With tools that read what is exported, which no package imports."""


def normal(name):
    return re.sub(r"[-_.]+", "-", name).lower()


def names(requirements):
    return {normal(re.match(r"[\w.-]+", requirement)[0]) for requirement in requirements}


def test_imported_packages_are_the_declared_dependencies():
    modules = {
        name for package in PACKAGES for path in (ROOT / package).rglob("*.py") for name, _ in imported(nodes_in(path))
    }
    foreign = modules - set(sys.stdlib_module_names) - set(PACKAGES)
    # The plugin is loaded by pytest alone; the others are parts of pydantic and numba.
    foreign -= {"pytest", "pydantic_core", "llvmlite"}
    # Each of them is named after its module, but for one.
    assert {normal({"yaml": "PyYAML"}.get(module, module)) for module in foreign} == names(REQUIRED)


def pins(name):
    """Versions by package of a list of pinned packages."""
    text = (ROOT / name).read_text(encoding="utf-8")
    return {normal(pin): version for pin, version in re.findall(r"^([\w.-]+)==([\w.]+)", text, re.MULTILINE)}


LOCKS = {"constraints.txt": names(DECLARED), "tests/packaging/mavproxy.txt": {"mavproxy", "pyserial"}}


@pytest.mark.parametrize("lock, packages", LOCKS.items())
def test_all_dependencies_are_locked_with_hashes(lock, packages):
    text = (ROOT / lock).read_text(encoding="utf-8")
    entries = [entry for entry in re.split(r"^(?=[\w.-]+==)", text, flags=re.MULTILINE) if not entry.startswith("#")]
    assert len(entries) == len(pins(lock))
    assert all(re.fullmatch(r"\S+( \\\n    --hash=sha256:[0-9a-f]{64})+\n", entry) for entry in entries)
    assert pins(lock).keys() >= packages
    assert "://" not in text  # any index will do


def test_lowest_versions_are_those_of_the_declared_dependencies():
    bounds = {normal(name): bound for name, bound in (re.match(r"([\w.-]+)>=([\w.]+)", d).groups() for d in DECLARED)}
    lowest = pins("tests/packaging/lowest.txt")

    def number(version):
        parts = tuple(map(int, version.split(".")))
        return parts + (0,) * (4 - len(parts))

    assert {name: number(lowest[name]) for name in bounds} == {name: number(bound) for name, bound in bounds.items()}


def test_notice_names_every_locked_package_with_a_licence():
    lines = (ROOT / "NOTICE").read_text(encoding="utf-8").splitlines()
    stated = dict(line.split(": ", 1) for line in lines if re.match(r"[\w.-]+ [\d.]+: ", line))
    assert stated.keys() == {f"{name} {version}" for lock in LOCKS for name, version in pins(lock).items()}
    assert "not stated" not in stated.values()
    assert [stated[f"{name} {pins('constraints.txt')[name]}"] for name in ("pymavlink", "hypothesis")] == [
        "LGPL-3.0",
        "MPL-2.0",
    ]


def test_package_holds_no_symbolic_links():
    assert not [path for package in PACKAGES for path in (ROOT / package).rglob("*") if path.is_symlink()]


def test_public_names_are_documented_and_the_packages_say_what_is_not_public():
    assert all(getattr(gcs, name).__doc__ for name in gcs.__all__)
    assert (ROOT / "gcs" / "py.typed").exists()
    assert "may change" in gcs.__doc__
    assert "Not public" in vehicle_sim.__doc__ and "Not public" in idc_controller.__doc__


def test_version_has_a_dated_entry_in_the_changelog():
    entries = re.findall(r"^## \[(\d\S+)\] - (\d{4}-\d\d-\d\d)$", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert entries[0][0] == PROJECT["version"]


def test_all_packages_are_installed():
    found = {".".join(path.parent.relative_to(ROOT).parts) for top in PACKAGES for path in (ROOT / top).rglob("*.py")}
    assert {*PYPROJECT["tool"]["setuptools"]["packages"]} == {*found, "gcs.missions"}


def test_development_has_all_extras():
    assert EXTRAS["dev"][0] == "cooplift[cluster,film,parquet,suites,ulog]"
    assert EXTRAS.keys() == {"cluster", "dev", "film", "parquet", "suites", "ulog"}


@pytest.mark.parametrize(
    "words, package, extra",
    [
        ("faults many_hops --parquet", "pyarrow", "parquet"),
        ("courses --suite course.yaml", "yaml", "suites"),
        ("courses --scheduler tcp://127.0.0.1:1", "distributed", "cluster"),
    ],
)
def test_command_that_needs_an_extra_names_it(words, package, extra, monkeypatch, tmp_path, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, package, None)  # as if it were not installed
    monkeypatch.delitem(sys.modules, "gcs.campaign.suites.yaml_file", raising=False)
    monkeypatch.delitem(sys.modules, "gcs.campaign.suites.aerialist", raising=False)
    monkeypatch.delitem(sys.modules, "gcs.campaign.cluster", raising=False)
    assert main(words.split()) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and f"needs {package}" in error and f"pip install 'cooplift[{extra}]'" in error
    assert not list(tmp_path.iterdir())
