"""The figures of README.md and docs/*.md are those of docs/claims.toml, and the comparison notices what is wrong."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "claims"))

import sources
from claims import FILE, RECORD, documents, printed, problems, written
from claims_file import Claim, ClaimsError, ClaimsFile, Definition, Figure, Source, last_digit, number, read_claims
from documents import found_figures
from sources import Measured, Record, Values, run


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


@pytest.mark.parametrize(
    ("figure", "text", "right", "wrong"),
    [
        (Figure("x"), "0.64", (0.6351, 0.6449), (0.634, 0.646)),
        (Figure("x"), "13", (12.51, 13.49), (12.4, 13.6)),
        (Figure("x"), "1e-5", (1.2e-5,), (2e-5,)),
        (Figure("x"), "60,000", (60_000.0,), (60_001.0,)),
        (Figure("x", ">="), "0.61", (0.61, 0.6199), (0.6099, 0.63)),
        (Figure("x", "<="), "0.9", (0.9, 0.81), (0.91, 0.79)),
        (Figure("x", tolerance=30.0, relative=True), "10", (7.1, 12.9), (6.9, 13.1)),
        (Figure("x", exact=True), "0.2", (0.2, 0.30000000000000004 - 0.1), (0.25,)),
        (Figure("x", tolerance=0.5), "10", (9.6, 10.4), (9.4, 10.6)),
    ],
)
def test_values_that_a_figure_allows(figure, text, right, wrong):
    least, most = figure.allowed(text)
    assert all(least <= value <= most for value in right)
    assert not any(least <= value <= most for value in wrong)


def test_text_of_a_claim_has_bounds_and_tolerances():
    claim = Claim("a.md", "x", "at least {>= min(a)} m, {b.c ~20%} s and {d ~0.1} deg, {e}")
    assert claim.figures == [
        Figure("min(a)", ">="), Figure("b.c", "", 20.0, True), Figure("d", "", 0.1), Figure("e"),
    ]  # fmt: skip
    found = found_figures(claim, "It is at least\n  0.61 m, 1.2 s and -3 deg, 1e-5.")
    assert [part.text for part in found] == ["0.61", "1.2", "-3", "1e-5"]
    assert found_figures(claim, "It is at least") == []


@pytest.mark.parametrize(
    ("bound", "text", "value", "expected"),
    [
        ("", "0.64", 0.6371, "0.64"),
        ("", "60,000", 63504.0, "63,504"),
        ("", "1e-5", 2e-5, "2e-5"),
        (">=", "0.64", 0.6371, "0.63"),
        ("<=", "0.9", 0.91, "1.0"),
        (">=", "0.60", 0.63, "0.63"),
        (">=", "0.60", 0.29, "0.29"),
    ],
)
def test_values_are_written_as_figures_are_printed(bound, text, value, expected):
    [found] = found_figures(Claim("a.md", "x", f"is {{{bound} x}} m"), f"is {text} m")
    assert printed(value, found) == expected
    least, most = found.figure.allowed(expected)
    assert least <= value <= most


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


def test_record_of_another_command_does_not_count(tmp_path):
    record = Record(tmp_path / "measured.json")
    record.measured["flight"] = Measured("commit 1", "fly slowly", {"duration": 4.21, "rows.n": 2.0})
    assert record.lacks(Source("flight", "fly"), ["duration"])
    assert not record.lacks(Source("flight", "fly slowly"), ["duration"])
    assert record.lacks(Source("flight", "fly slowly"), ["duration", "height"])


def test_results_of_commands_are_json_or_tables(tmp_path, monkeypatch):
    monkeypatch.setattr(sources, "RUNS", tmp_path)
    read = run(Source("flight", 'echo \'{"a": {"b": 2}}\''), "commit 1", ["a.b", "a.b + 1"])
    assert read == Measured("commit 1", 'echo \'{"a": {"b": 2}}\'', {"a.b": 2.0, "a.b + 1": 3.0})
    command = "printf 'x,kind\\n1,a\\n3,b\\n' > $OUT/t.csv; exit 1"
    assert run(Source("campaign", command, "t.csv"), "", ['x[kind == "b"].min()', "len(x)"]).values == {
        'x[kind == "b"].min()': 3.0, "len(x)": 2.0,
    }  # fmt: skip
    assert not any(tmp_path.iterdir())
    with pytest.raises(ClaimsError, match="exit status 2"):
        run(Source("campaign", "exit 2"), "", [])
    with pytest.raises(ClaimsError, match="cannot be computed"):
        run(Source("flight", "echo '{}'"), "", ["a"])


def test_unusable_files_are_refused(tmp_path):
    path = tmp_path / "claims.toml"
    rest = "functions = []\nrows = []\ngenerated = []\nsources = {}\ndefinitions = {}\n"
    path.write_text(rest + '[claims."README.md"]\nflight = ["{x} m"]\n')
    with pytest.raises(ClaimsError, match="no such source: flight"):
        read_claims(path)
    path.write_text(rest + '[claims."README.md"]\nsettings = ["3 m"]\n')
    with pytest.raises(ClaimsError, match="no figure"):
        read_claims(path)
    path.write_text(rest + "claims = {}\nclaim = {}\n")
    with pytest.raises(ClaimsError, match="unknown: claim"):
        read_claims(path)
