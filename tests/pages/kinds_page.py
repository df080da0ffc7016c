"""The tables of kinds in ``docs/faults.md``: ``python tests/pages/kinds_page.py docs/faults.md`` renews them."""

import sys
from itertools import groupby
from pathlib import Path

from gcs.faults.kind import KINDS
from gcs.faults.listing import Parameter, about, own_parameters, shared_parameters, summary


def kinds_markdown() -> str:
    """Return the same list as the tables of ``docs/faults.md``."""
    lines: list[str] = []
    for family, kinds in groupby(KINDS.values(), lambda kind: kind.family):
        lines += ["", f"### {family}", ""]
        if family == "values":
            lines += ["All but `swapped_vehicles` have:", "", *(f"- {_sentence(p)}" for p in shared_parameters()), ""]
        lines += ["| kind | what it does | parameters |", "|---|---|---|"]
        for kind in kinds:
            own = "<br>".join(_sentence(p) for p in own_parameters(kind)) or "none of its own"
            lines.append(f"| `{kind.name}` | {summary(kind)} | {own} |")
    return "\n".join(lines).strip() + "\n"


def renewed(page: str) -> str:
    """Return ``docs/faults.md``, which ends with the tables, with those of the present kinds."""
    text, heading, _ = page.rpartition("## Kinds\n\n")
    return text + heading + kinds_markdown()


def _sentence(p: Parameter) -> str:
    return f"`{p.name}` ({about(p)}): {p.description}"


if __name__ == "__main__":
    documentation = Path(sys.argv[1])
    documentation.write_text(renewed(documentation.read_text(encoding="utf-8")), encoding="utf-8")
