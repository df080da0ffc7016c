"""The project as of another commit, beside the work tree and ready to fly in the same environment."""

import os
import subprocess
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[2]


@contextmanager
def tree_of(commit):
    """Check ``commit`` out into a folder of its own with its kernels compiled; yield it, and remove it."""
    git = ["git", "-C", str(ROOT), "worktree"]
    with tempfile.TemporaryDirectory() as scratch:
        tree = Path(scratch) / "tree"
        subprocess.run([*git, "add", "--quiet", "--detach", str(tree), commit], check=True)
        try:
            _compile_kernels(tree)
            yield tree
        finally:
            subprocess.run([*git, "remove", "--force", str(tree)], check=True)


def environment_of(tree):
    """Return the variables with which ``python -m gcs`` is that of ``tree``, not the installed one."""
    return {**os.environ, "PYTHONPATH": str(tree)}


def _compile_kernels(tree):
    if (tree / "vehicle_sim" / "app" / "compile_kernels.py").exists():
        command = [sys.executable, "-m", "vehicle_sim.app.compile_kernels"]
        subprocess.run(command, cwd=tree, env=environment_of(tree), stdout=subprocess.DEVNULL, check=True)
