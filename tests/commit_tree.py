"""The project as of another commit, beside the work tree and ready to fly in the same environment."""

import os
import shutil
import subprocess
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[1]


@contextmanager
def tree_of(commit):
    """Check ``commit`` out into a folder of its own with its kernels compiled; yield it, and remove it."""
    git = ["git", "-C", str(ROOT), "worktree"]
    with tempfile.TemporaryDirectory() as scratch:
        tree = Path(scratch) / "tree"
        subprocess.run([*git, "add", "--quiet", "--detach", str(tree), commit], check=True)
        try:
            _copy_kernels(tree)
            _compile_kernels(tree)
            yield tree
        finally:
            subprocess.run([*git, "remove", "--force", str(tree)], check=True)


def environment_of(tree):
    """Return the variables with which ``python -m gcs`` is that of ``tree``, not the installed one."""
    return {**os.environ, "PYTHONPATH": str(tree)}


def _copy_kernels(tree):
    """Copy machine code of the work tree, which serves where the kernels are equal: files are named by checksum."""
    for package in ("idc_controller", "gcs", "vehicle_sim"):
        for file in (ROOT / package).rglob("__pycache__/*.nb?"):
            folder = tree / file.parent.relative_to(ROOT)
            if folder.parent.exists():
                folder.mkdir(exist_ok=True)
                shutil.copy2(file, folder)


def _compile_kernels(tree):
    if (tree / "vehicle_sim" / "app" / "compile_kernels.py").exists():
        command = [sys.executable, "-m", "vehicle_sim.app.compile_kernels"]
        subprocess.run(command, cwd=tree, env=environment_of(tree), stdout=subprocess.DEVNULL, check=True)
