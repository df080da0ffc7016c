"""The figures of a document, and those that neither a claim nor a definition covers.

A figure is a number in digits, outside of code, headings and targets of links, that has a unit, a decimal point or two
digits, or stands alone in the cell of a table. Others are codes, ordinals and values of fields.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from claims_file import NUMBER, Claim, ClaimsFile, Definition, Figure, Generated

_NO_FIGURES = (
    re.compile(r"^ *```.*?^ *```$", re.MULTILINE | re.DOTALL),  # code
    re.compile(r"<!--.*?-->", re.DOTALL),
    re.compile(r"`[^`]*`"),
    re.compile(r"\]\([^)\s]*\)"),  # target of a link
    re.compile(r"^#.*$", re.MULTILINE),  # heading
    re.compile(r"^ *\d+\. ", re.MULTILINE),  # number of a list item
)
_UNIT = r"\s?(?:%|(?:mm?|km|s|ms|min|deg|degrees|rad|Hz|kg|N|g|bytes|times|hours|days)\b)"
_FIGURE = re.compile(
    rf"(?<![\w.#/-])(?P<number>{NUMBER})(?!\w)(?:(?P<unit>(?:\s(?:to|and|or|x|/)\s{NUMBER})*{_UNIT})|(?P<cell>\s\|))?"
)


@dataclass(frozen=True)
class Found:
    """A figure of a claim in its document: its text, and where it begins and ends."""

    claim: Claim
    figure: Figure
    text: str
    begin: int
    end: int


def found_figures(claim: Claim, document: str) -> list[Found]:
    """Return the figures of a claim in the text of its document; none where its text is not found just once."""
    matches = list(claim.pattern.finditer(document))
    if len(matches) != 1:
        return []
    [match] = matches
    return [
        Found(claim, figure, match[group], *match.span(group)) for group, figure in enumerate(claim.figures, start=1)
    ]


def uncovered(name: str, text: str, claims: ClaimsFile) -> list[str]:
    """Return a line for each figure of the document ``name`` that is in no claim, definition or generated part."""
    covered = [(found.begin, found.end) for claim in _of(name, claims.claims) for found in found_figures(claim, text)]
    covered += [match.span() for part in _of(name, claims.definitions) for match in part.pattern.finditer(text)]
    readable = _without(text, _of(name, claims.generated))
    problems = []
    for match in _FIGURE.finditer(readable):
        begin, end = match.span("number")
        alone = match["cell"] and readable[:begin].endswith("| ")
        if not (match["unit"] or alone or re.search(r"\d\d|[.e]", match["number"])):
            continue
        if not any(first <= begin and end <= last for first, last in covered):
            line = text.count("\n", 0, begin) + 1
            around = " ".join(text[max(0, begin - 40) : end + 30].split())
            problems.append(f"{name}:{line}: {match['number']} is in no claim: ... {around} ...")
    return problems


def _of(name: str, parts: Iterable[Claim | Definition | Generated]) -> list[Claim | Definition | Generated]:
    return [part for part in parts if part.document == name]


def _without(text: str, generated: Iterable[Generated]) -> str:
    """Return the text with blanks in place of what has no figures of its own, at the same length."""
    for part in generated:
        begin = text.index(part.begin) if part.begin else 0
        end = text.index(part.end, begin) if part.end else len(text)
        text = text[:begin] + _blank(text[begin:end]) + text[end:]
    for pattern in _NO_FIGURES:
        text = pattern.sub(lambda match: _blank(match[0]), text)
    return text


def _blank(text: str) -> str:
    return re.sub(r"[^\n]", " ", text)
