"""Reading of ``docs/claims.toml``: claims, definitions, sources, and what is generated."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

NUMBER = r"[-+−±]?\d(?:[\d,]*\d)?(?:\.\d+)?(?:e[-+]?\d+)?"
SETTINGS = "settings"
MODULE = "module "
CLASSES = ("setting", "seconds", "minutes")
"""How long figures take: a constant of the code, a computation, flights."""
_PLACE = re.compile(r"\{([^{}]+)\}")
_PLACEHOLDER = re.compile(r"(?P<bound>[<>]=)?\s*(?P<expression>.+?)\s*(?:~\s*(?P<tolerance>[\d.]+)(?P<percent>\s*%)?)?")


class ClaimsError(Exception):
    """The file of claims cannot be used."""


@dataclass(frozen=True)
class Figure:
    """What a placeholder of a claim's text says: an expression, and how far a document's figure may be from it.

    ``bound`` is ``>=`` where the measured value is at least the figure, ``<=`` where it is at most that, else empty.
    Without a ``tolerance`` the last printed digit counts: half of it to either side, all of it to the side of a bound;
    an ``exact`` figure is the value.
    """

    expression: str
    bound: str = ""
    tolerance: float | None = None
    relative: bool = False
    exact: bool = False

    def allowed(self, figure: str) -> tuple[float, float]:
        """Return the least and the largest value for which ``figure`` is right."""
        printed, digit = number(figure), last_digit(figure)
        if self.tolerance is None:
            spread = 0.0 if self.exact else digit if self.bound else digit / 2.0
        else:
            spread = self.tolerance * abs(printed) / 100.0 if self.relative else self.tolerance
        rounding = 1e-9 * max(abs(printed), digit)
        return (
            printed - (0.0 if self.bound == ">=" else spread) - rounding,
            printed + (0.0 if self.bound == "<=" else spread) + rounding,
        )


@dataclass(frozen=True)
class Claim:
    """A text of a document with placeholders for its figures, and the source of their values."""

    document: str
    source: str
    text: str

    @property
    def figures(self) -> list[Figure]:
        """The placeholders, in their order; settings and constants are printed as they are."""
        return [_figure(match, is_constant(self.source)) for match in _PLACE.findall(self.text)]

    @property
    def pattern(self) -> re.Pattern[str]:
        """The text as an expression that finds it in the document, a group a figure."""
        parts = _PLACE.split(self.text)
        return re.compile(f"({NUMBER})".join(_literal(part) for part in parts[::2]))


@dataclass(frozen=True)
class Definition:
    """A text of a document whose figures define or quote something, so that nothing measures them."""

    document: str
    text: str
    reason: str

    @property
    def pattern(self) -> re.Pattern[str]:
        """The text as an expression that finds it in the document."""
        return re.compile(rf"(?<![\w.]){_literal(self.text)}(?!\w|\.\d)")


@dataclass(frozen=True)
class Source:
    """What figures are measured by: a function of ``measures.py`` where ``command`` is empty, else a shell command.

    ``result`` is empty for JSON on standard output, else a CSV file in the folder $OUT; ``pages`` are documents that
    the command writes; ``minutes`` of CPU that it takes.
    """

    name: str
    command: str = ""
    result: str = ""
    pages: tuple[str, ...] = ()
    minutes: float = 0.0


@dataclass(frozen=True)
class Generated:
    """A document, or the part of it from ``begin`` to ``end``, that a command writes and a test compares."""

    document: str
    by: str
    begin: str = ""
    end: str = ""


@dataclass(frozen=True)
class ClaimsFile:
    """All of the file."""

    claims: tuple[Claim, ...]
    definitions: tuple[Definition, ...]
    sources: dict[str, Source]
    generated: tuple[Generated, ...]

    def kind(self, source: str) -> str:
        """Return the class of a source: how long its figures take."""
        if is_constant(source):
            return "setting"
        return "minutes" if self.sources[source].command else "seconds"


def read_claims(path: Path) -> ClaimsFile:
    """Read the file; raises :class:`ClaimsError` for an unknown key or source."""
    data = tomllib.loads(path.read_text(encoding="utf-8"))
    if unknown := data.keys() - {"functions", "sources", "rows", "claims", "definitions", "generated"}:
        raise ClaimsError(f"{path}: unknown: {', '.join(sorted(unknown))}")
    sources = {name: Source(name) for name in data["functions"]}
    sources |= {name: _source(name, **keys) for name, keys in data["sources"].items()}
    claims = [
        Claim(table["document"], source, text + table["ending"])
        for table in data["rows"] for source, text in table["texts"].items()
    ]  # fmt: skip
    claims += [Claim(document, source, text) for document, source, text in _texts(data["claims"])]
    definitions = [Definition(document, text, reason) for document, reason, text in _texts(data["definitions"])]
    generated = [Generated(**table) for table in data["generated"]]
    for claim in claims:
        if not (is_constant(claim.source) or claim.source in sources):
            raise ClaimsError(f"{path}: no such source: {claim.source}")
        if not claim.figures:
            raise ClaimsError(f"{path}: no figure in {claim.text!r}")
    return ClaimsFile(tuple(claims), tuple(definitions), sources, tuple(generated))


def is_constant(source: str) -> bool:
    """Return whether a source is the settings or a module."""
    return source == SETTINGS or source.startswith(MODULE)


def number(figure: str) -> float:
    """Return a printed number."""
    return float(figure.replace(",", "").replace("−", "-").lstrip("±"))


def last_digit(figure: str) -> float:
    """Return what one unit of the last printed digit is worth."""
    mantissa, _, exponent = figure.partition("e")
    return float(10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2])))


def _texts(table: dict[str, dict[str, list[str]]]) -> Iterator[tuple[str, str, str]]:
    """Yield the document, the source or reason, and the text of each entry."""
    for document, groups in table.items():
        for name, texts in groups.items():
            for text in texts:
                yield document, name, text


def _source(
    name: str, minutes: float, prepare: str = "", flight: str = "", campaign: str = "", command: str = "",
    pages: Sequence[str] = (),
) -> Source:  # fmt: skip
    result = ""
    if flight:
        command = f"gcs fly {flight} --no-pictures --json --run-dir $OUT/run"
    elif campaign:
        command, result = f"gcs {campaign} --keep none --out $OUT/campaign", "campaign/results.csv"
    return Source(name, f"{prepare}\n{command}".strip(), result, tuple(pages), minutes)


def _figure(placeholder: str, exact: bool) -> Figure:
    match = _PLACEHOLDER.fullmatch(placeholder.strip())
    if match is None:
        raise ClaimsError(f"cannot be read: {{{placeholder}}}")
    tolerance = None if match["tolerance"] is None else float(match["tolerance"])
    return Figure(match["expression"], match["bound"] or "", tolerance, bool(match["percent"]), exact)


def _literal(text: str) -> str:
    """Return an expression for a text that may be wrapped anywhere."""
    return r"\s+".join(re.escape(word) for word in re.split(r"\s+", text))
