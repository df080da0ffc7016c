"""Compare the CPU cost of flights with that of an earlier commit, in turns on one core; `make benchmark-check`.

    python tests/benchmarks/check.py [--base COMMIT] [--rounds 5]

Exit status 1, with the ratio, if a flight costs more than 10 % above the base's in the median of the rounds, and more
than it in every round: beyond the spread. Both trees run in this environment.
"""

import argparse
import statistics
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))

from commit_tree import tree_of
from measure import FLIGHTS, ROOT, fly, use_one_core, write, write_missions

from gcs.campaign.scenarios.generator import generate
from gcs.config import read_system

LIMIT = 1.10
DURATION = 5.0  # s
FOREST = ("forest", 20.0)
"""Name of the flight through an unknown forest, and how much of it is flown (s)."""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--base", default="HEAD~1", help="commit to compare with (default: %(default)s)")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    use_one_core()
    with tree_of(options.base) as base, tempfile.TemporaryDirectory() as scratch:
        return compare(base, Path(scratch), options)


def compare(base, scratch, options):
    missions = {}
    for tree in (base, ROOT):
        folder = scratch / f"missions of {'base' if tree is base else 'head'}"
        folder.mkdir()
        forest = write(folder, FOREST[0], generate(2902, 1, "forest", read_system(), 2.0).text)
        missions[tree] = {**write_missions(tree, folder, DURATION), FOREST[0]: forest}
    dearer = []
    for name in (*FLIGHTS, FOREST[0]):
        until = ("--until", FOREST[1]) if name == FOREST[0] else ()
        ratios = []
        for k in range(options.rounds):
            cost = {}
            for tree in (base, ROOT) if k % 2 else (ROOT, base):
                cost[tree] = fly(tree, missions[tree][name], *until)["ms_per_second"]
            ratios.append(cost[ROOT] / cost[base])
        median = statistics.median(ratios)
        spread = f"{min(ratios):.2f} to {max(ratios):.2f}"
        verdict = "dearer" if is_dearer(ratios) else "not dearer"
        print(f"{name}: {median:.2f} of the CPU time of {options.base} ({spread}): {verdict}", flush=True)
        if is_dearer(ratios):
            dearer.append(f"{name} {median:.2f}")
    if dearer:
        print(f"CPU cost above {LIMIT:.2f} of that of {options.base}: {', '.join(dearer)}", file=sys.stderr)
    return 1 if dearer else 0


def is_dearer(ratios):
    """Return whether the median is above the limit, beyond the spread."""
    return statistics.median(ratios) > LIMIT and min(ratios) > 1.0


if __name__ == "__main__":
    sys.exit(main())
