"""Imports run one way only: idc_controller <- gcs <- vehicle_sim, along the edges of a table, without a cycle."""

import ast
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

FORBIDDEN = {
    # Pure mathematics: no wire, clock, log or file.
    "idc_controller": {
        "gcs", "vehicle_sim", "pybullet", "pymavlink", "socket", "socketserver", "asyncio", "select", "selectors",
        "time", "datetime", "logging", "threading", "subprocess", "pathlib", "io", "os",
    },
    "gcs": {"vehicle_sim", "pybullet"},
    "vehicle_sim": set(),
}  # fmt: skip

ALLOWED = {
    # Which sub-package may import which others. Another edge is a decision about the structure: make it here.
    "gcs.app": (
        "gcs.campaign gcs.config gcs.drivers gcs.faults gcs.flight gcs.mavlink gcs.mission gcs.record "
        "gcs.reproduce gcs.serve gcs.view idc_controller.guidance idc_controller.paper idc_controller.safety"
    ),
    "gcs.campaign": (
        "gcs.config gcs.faults gcs.flight gcs.mission gcs.planning gcs.record idc_controller.geometry "
        "idc_controller.guidance"
    ),
    "gcs.config": "",
    "gcs.drivers": "gcs.config gcs.flight gcs.mavlink",
    "gcs.faults": "gcs.config",
    "gcs.flight": (
        "gcs.config gcs.mavlink gcs.mission idc_controller.control idc_controller.estimation "
        "idc_controller.geometry idc_controller.guidance idc_controller.model idc_controller.perception "
        "idc_controller.safety idc_controller.trajectory"
    ),
    "gcs.mavlink": "idc_controller.estimation idc_controller.perception",
    "gcs.mission": "gcs.config gcs.faults idc_controller.geometry idc_controller.perception",
    "gcs.planning": (
        "gcs.flight gcs.mission gcs.record idc_controller.control idc_controller.estimation idc_controller.guidance "
        "idc_controller.model idc_controller.perception idc_controller.safety idc_controller.trajectory"
    ),
    "gcs.record": (
        "gcs.config gcs.flight gcs.mavlink gcs.mission idc_controller.control idc_controller.estimation "
        "idc_controller.geometry idc_controller.perception idc_controller.trajectory"
    ),
    "gcs.reproduce": (
        "gcs.campaign gcs.config gcs.flight gcs.record idc_controller.estimation idc_controller.geometry "
        "idc_controller.guidance idc_controller.model idc_controller.paper idc_controller.safety "
        "idc_controller.trajectory"
    ),
    "gcs.serve": (
        "gcs.config gcs.flight gcs.mavlink gcs.mission idc_controller.control idc_controller.estimation "
        "idc_controller.trajectory"
    ),
    "gcs.view": "gcs.mavlink gcs.mission gcs.record idc_controller.geometry",
    "idc_controller.control": (
        "idc_controller.estimation idc_controller.guidance idc_controller.model idc_controller.qp "
        "idc_controller.safety idc_controller.trajectory"
    ),
    "idc_controller.estimation": "idc_controller.model idc_controller.trajectory",
    "idc_controller.geometry": "",
    "idc_controller.guidance": "idc_controller.geometry idc_controller.model idc_controller.trajectory",
    "idc_controller.model": "",
    "idc_controller.paper": (
        "idc_controller.control idc_controller.estimation idc_controller.geometry idc_controller.model "
        "idc_controller.qp idc_controller.safety"
    ),
    "idc_controller.perception": "idc_controller.estimation idc_controller.geometry",
    "idc_controller.qp": "",
    "idc_controller.safety": (
        "idc_controller.estimation idc_controller.geometry idc_controller.model idc_controller.qp "
        "idc_controller.trajectory"
    ),
    "idc_controller.trajectory": "idc_controller.model",
    "vehicle_sim.app": (
        "gcs.app gcs.config gcs.drivers gcs.faults gcs.mavlink gcs.mission gcs.record vehicle_sim.faults "
        "vehicle_sim.swarm vehicle_sim.world"
    ),
    "vehicle_sim.autopilot": "gcs.config gcs.mavlink idc_controller.trajectory vehicle_sim.world",
    # gcs.flight: the mission's trajectory alone, which says when its phases begin.
    "vehicle_sim.faults": "gcs.config gcs.faults gcs.flight gcs.mavlink gcs.mission gcs.record vehicle_sim.world",
    "vehicle_sim.in_process": (
        "gcs.drivers gcs.faults gcs.mavlink gcs.mission gcs.record vehicle_sim.faults vehicle_sim.swarm "
        "vehicle_sim.world"
    ),
    "vehicle_sim.mavlink": "gcs.config gcs.mavlink gcs.mission vehicle_sim.autopilot vehicle_sim.world",
    "vehicle_sim.sensing": "gcs.mission vehicle_sim.world",
    "vehicle_sim.swarm": (
        "gcs.config gcs.mavlink gcs.mission vehicle_sim.autopilot vehicle_sim.faults vehicle_sim.mavlink "
        "vehicle_sim.team vehicle_sim.world"
    ),
    "vehicle_sim.team": (
        "gcs.config gcs.mission vehicle_sim.autopilot vehicle_sim.faults vehicle_sim.mavlink vehicle_sim.world"
    ),
    "vehicle_sim.world": (
        "gcs.config gcs.mission gcs.record idc_controller.geometry idc_controller.model idc_controller.perception"
    ),
}
SETTINGS = sorted((*ROOT.glob("idc_controller/*/settings.py"), *ROOT.glob("gcs/*/settings.py")))
COMMON = {
    f"idc_controller.{name}"
    for name in (
        "arrays",
        "compiled",
        "errors",
        "parameters",
        "rotations",
        "rotations_float",
        "settings",
        "uncompiled",
    )
} | {"gcs.errors", "gcs.extras", "gcs.numerics"}
"""Modules beside the sub-packages that everything above them may import."""


@cache
def nodes_in(path):
    """All nodes of the syntax tree of the module at ``path``, which every check reads."""
    return [*ast.walk(ast.parse(path.read_text(encoding="utf-8")))]


@pytest.fixture(scope="module", autouse=True)
def forget_syntax_trees():
    """Leave no million of objects to the collections of garbage of later tests."""
    yield
    nodes_in.cache_clear()


def imported(nodes):
    """Top-level names of the modules that a source with these nodes imports, wherever it does, with the line."""
    for node in nodes:
        if isinstance(node, ast.Import):
            yield from ((alias.name.split(".")[0], node.lineno) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            yield node.module.split(".")[0], node.lineno
        elif isinstance(node, ast.Call):  # import by name
            called = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            if called in ("__import__", "import_module") and node.args:
                name = node.args[0]
                if isinstance(name, ast.Constant) and isinstance(name.value, str):
                    yield name.value.split(".")[0], node.lineno


def violations(package, path, nodes):
    return [f"{path}:{line} imports {name}" for name, line in imported(nodes) if name in FORBIDDEN[package]]


@pytest.mark.parametrize("package", sorted(FORBIDDEN))
def test_packages_import_in_one_direction(package):
    files = sorted((ROOT / package).rglob("*.py"))
    assert files
    found = [line for path in files for line in violations(package, path.relative_to(ROOT), nodes_in(path))]
    assert not found, "\n".join(found)


def test_pybullet_is_imported_by_the_simulator_only():
    users = {
        path.relative_to(ROOT).parts[0]
        for package in FORBIDDEN
        for path in (ROOT / package).rglob("*.py")
        if "pybullet" in {name for name, _ in imported(nodes_in(path))}
    }
    assert users == {"vehicle_sim"}


def sub_packages_imported(path):
    """Sub-packages of the project that the module at ``path`` imports, each with the line."""
    for node in nodes_in(path):
        if isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            continue
        for name in names:
            top, _, rest = name.partition(".")
            if top in FORBIDDEN and rest:
                package, _, module = rest.partition(".")
                yield f"{top}.{package}" + (".settings" if f"{module}.".startswith("settings.") else ""), node.lineno


@pytest.mark.parametrize("package", ALLOWED)
def test_sub_package_imports_only_what_the_table_allows(package):
    top, _, name = package.partition(".")
    place = ROOT / top / name
    files = [place.with_suffix(".py")] if place.with_suffix(".py").exists() else sorted(place.rglob("*.py"))
    assert files
    allowed = {*ALLOWED[package].split(), package} | COMMON
    allowed |= {f"{name}.settings" for name in allowed}
    if package == "gcs.config":  # assembles the tables that the sub-packages declare
        allowed |= {f"{path.parts[-3]}.{path.parts[-2]}.settings" for path in SETTINGS}
    found = [
        f"{path.relative_to(ROOT)}:{line} imports {name}"
        for path in files
        for name, line in sub_packages_imported(path)
        if name not in allowed
    ]
    assert not found, "\n".join(found)


@pytest.mark.parametrize("path", SETTINGS, ids=lambda path: path.parts[-2])
def test_settings_module_imports_mathematics_only(path):
    """gcs.config assembles these modules, so they must not import it."""
    assert all(name.startswith("idc_controller.") for name, _ in sub_packages_imported(path))


PROTOCOL = {
    "address", "codec", "frames", "layout", "lockstep", "messages", "newer_messages", "px4", "stop_plan",
    "team_failsafe", "udp",
}  # fmt: skip
"""Modules of gcs.mavlink that both ends of the wire share; the others are the ground's links."""


def mavlink_modules_imported(path):
    """Modules of gcs.mavlink that the module at ``path`` imports."""
    for node in nodes_in(path):
        if isinstance(node, ast.ImportFrom) and f"{node.module}.".startswith("gcs.mavlink."):
            yield from (
                [alias.name for alias in node.names] if node.module == "gcs.mavlink" else [node.module.split(".")[2]]
            )


def test_vehicles_import_only_the_protocol_of_the_ground_station():
    used = {name for path in (ROOT / "vehicle_sim").rglob("*.py") for name in mavlink_modules_imported(path)}
    assert used == {*PROTOCOL, "services"}


def test_services_import_nothing_of_what_they_serve():
    """They serve a vehicle or the team, behind ``gcs.mavlink.services.aircraft``."""
    for path in (ROOT / "gcs" / "mavlink" / "services").glob("*.py"):
        assert {*mavlink_modules_imported(path)} <= {*PROTOCOL, "services", "settings"}
        assert {name for name, _ in sub_packages_imported(path)} <= {
            "gcs.mavlink",
            "gcs.errors",
            "gcs.mavlink.settings",
            "idc_controller.rotations_float",
        }


@pytest.mark.parametrize("name", sorted(PROTOCOL))
def test_protocol_does_not_depend_on_the_links(name):
    path = ROOT / "gcs" / "mavlink" / f"{name}.py"
    assert {*mavlink_modules_imported(path)} <= {*PROTOCOL, "frame_kernels"}
    assert not [module for module, _ in sub_packages_imported(path) if module.startswith("idc_controller")]


def test_every_sub_package_is_in_the_table():
    folders = {
        f"{top}.{place.name}"
        for top in FORBIDDEN
        for place in (ROOT / top).iterdir()
        if (place / "__init__.py").exists()
    }
    assert folders == {*ALLOWED} - {f"vehicle_sim.{name}" for name in ("in_process", "sensing", "swarm", "team")}


def test_sub_packages_have_no_cycle():
    [*TopologicalSorter({package: allowed.split() for package, allowed in ALLOWED.items()}).static_order()]


def modules_imported(path, modules):
    """Those of ``modules`` that the module at ``path`` imports, wherever in the file it does."""
    for node in nodes_in(path):
        if isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            yield from {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)} & modules
        elif isinstance(node, ast.Import):
            yield from {alias.name for alias in node.names} & modules


def test_modules_have_no_cycle():
    paths = {
        ".".join(path.relative_to(ROOT).with_suffix("").parts): path
        for package in FORBIDDEN
        for path in (ROOT / package).rglob("*.py")
        if path.name != "__init__.py"
    }
    [*TopologicalSorter({name: {*modules_imported(path, {*paths})} for name, path in paths.items()}).static_order()]
