"""The figures of README.md and docs/*.md are those of docs/claims.toml, and the comparison notices what is wrong."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "claims"))

from claims import FILE, RECORD, documents, problems, written
from claims_file import Claim, ClaimsFile, Definition, Source, last_digit, number, read_claims
from documents import found_figures
from sources import Measured, Record, Values


@pytest.fixture(scope="module")
def claims():
    return read_claims(FILE)


@pytest.fixture(scope="module")
def values(claims):
    return Values(claims, Record(RECORD))


@pytest.fixture(scope="module")
def texts():
    return documents()


def test_figures_of_documents_agree_with_their_claims(claims, values, texts):
    """``make claims`` prints the same, and ``make claims-write`` corrects figures."""
    assert problems(claims, values, texts) == []


@pytest.mark.parametrize(
    ("document", "text", "changed"),
    [
        ("README.md", "0.006 m | 0.7 deg | 0.98 m |", "0.006 m | 0.7 deg | 0.88 m |"),
        ("docs/safety.md", "voxels of 0.25 m", "voxels of 0.2 m"),
        ("docs/faults.md", "by more than 10 ms are", "by more than 20 ms are"),
        ("docs/clients.md", "mavkit 0.3.0", "mavkit 0.4.0"),
        ("docs/architecture.md", "## The loop\n", "## The loop\n\nA step takes 3.7 ms.\n"),
    ],
)
def test_figure_that_was_changed_by_hand_is_named(claims, values, texts, document, text, changed):
    assert text in texts[document]
    found = problems(claims, values, texts | {document: texts[document].replace(text, changed, 1)})
    assert found
    assert all(line.startswith(document) for line in found)


def test_every_figure_of_a_claim_may_not_be_changed(claims, values, texts):
    for claim in claims.claims:
        for found in found_figures(claim, texts[claim.document]):
            value, digit = values.of(claim, found.figure), last_digit(found.text)
            for other in (0.2 * number(found.text) - 2.0 * digit, 4.0 * number(found.text) + 2.0 * digit):
                least, most = found.figure.allowed(f"{other:.6f}")
                assert not least <= value <= most, f"{claim.document}: {claim.text}"


def small_file():
    claim = Claim("README.md", "flight", "It takes {duration} s, {rows.n} of them.")
    definition = Definition("README.md", "Python 3.11", "a version")
    return ClaimsFile((claim,), (definition,), {"flight": Source("flight", "fly", minutes=1.0)}, ())


def test_figures_are_read_from_the_record_corrected_and_found_without_a_claim(tmp_path):
    record = Record(tmp_path / "measured.json")
    values = Values(small_file(), record)
    text = "Python 3.11. It takes 3.5 s, 2 of them. It weighs 3 kg, in 1 of 12.\n"
    assert any("make claims-all ONLY=flight" in line for line in problems(small_file(), values, {"README.md": text}))
    record.measured["flight"] = Measured("commit 1", "fly", {"duration": 4.21, "rows.n": 2.0})
    record.write()
    values = Values(small_file(), Record(tmp_path / "measured.json"))
    changed = written(small_file(), values, {"README.md": text})
    assert changed["README.md"] == text.replace("3.5", "4.2")
    unclaimed = problems(small_file(), values, changed)
    assert [line.split(" is in no claim")[0] for line in unclaimed] == ["README.md:1: 3", "README.md:1: 12"]
    # Code, headings, targets of links and single digits are no figures.
    passed = "# 12 parts\n\nPython 3.11. It takes 4.2 s,\n2 of them. 3 `a = 5.0`.\n\n```\n12 m\n```\n[x](a.md#12-m)\n"
    assert problems(small_file(), values, {"README.md": passed}) == []
