"""One line for one reason: the problems and notes of many rows or items, merged."""

import re
from collections.abc import Iterable, Sequence

SHOWN = 3
_LINE = re.compile(
    r"(?:(?P<line>line) (?P<at>\d+): )?"
    r"(?:(?P<item>row|item) (?P<number>[\d.]+)(?: \((?P<command>[^()]+)\))?: )?"
    r"(?P<reason>.+)"
)
_NUMBER = re.compile(r"((?<![\w.\[])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?)")


def merged(lines: Iterable[str]) -> tuple[str, ...]:
    """Return the lines, those that differ only in their row, command and numbers as one.

    ``line 4: row 2 (NAV_LAND): reason`` and its like become ``rows 2, 5, 6 and 40 more (NAV_LAND): reason``, numbers
    in which the reasons differ ``3 to 7``.
    """
    groups: dict[tuple[str, str], list[re.Match[str]]] = {}
    for line in dict.fromkeys(lines):
        match = _LINE.fullmatch(line)
        assert match is not None  # each of its parts is optional
        kind = match["item"] or match["line"]
        key = (kind, _NUMBER.sub("#", match["reason"])) if kind else ("", line)
        groups.setdefault(key, []).append(match)
    found = list[str]()
    for (kind, _), matches in groups.items():
        numbers = list(dict.fromkeys(match["number"] or match["at"] for match in matches))
        if len(numbers) < 2:
            found += [match.string for match in matches]
            continue
        more = len(numbers) - SHOWN
        last = f"{more} more" if more > 0 else numbers.pop()
        which = f"{', '.join(numbers[:SHOWN])} and {last}"
        commands = dict.fromkeys(match["command"] for match in matches if match["command"])
        named = f" ({', '.join(commands)})" if commands else ""
        found.append(f"{kind}s {which}{named}: {_with_ranges([match['reason'] for match in matches])}")
    return tuple(found)


def _with_ranges(reasons: Sequence[str]) -> str:
    """Return one reason for several that differ in their numbers."""
    columns = zip(*(_NUMBER.split(reason) for reason in reasons), strict=True)
    return "".join(c[0] if len(set(c)) == 1 else f"{min(c, key=float)} to {max(c, key=float)}" for c in columns)
