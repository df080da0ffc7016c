"""The report page in Chromium: no error, the slider, the keys, the events, and a layout in which nothing overlaps."""

import json
import shutil

import numpy as np
import pytest
from browser import Browser
from growing_run import served, write_until
from recorded_run import BALL, write_plan, write_reference, write_steps, write_truth

from gcs.record.outcome import Outcome
from gcs.record.run_data import read_run
from gcs.record.run_folder import open_run_folder, write_json
from gcs.record.summary import summarise
from gcs.record.tables import ALARM_COLUMNS, HORIZON_COLUMNS, PHASE_COLUMNS, TableWriter
from gcs.record.verdict import Verdict
from gcs.view.campaign_page import write_campaign
from gcs.view.page import write_report

pytestmark = pytest.mark.slow

SIZES = {"wide": (1280, 800), "narrow": (390, 844)}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Ten seconds past a sphere, with a fault that is detected and a channel that is isolated."""
    folder = open_run_folder("hover", tmp_path_factory.mktemp("report") / "run")
    write_truth(folder, standing=[BALL])
    write_reference(folder)
    write_plan(folder, slack=0.0, off=0.05)
    write_steps(folder)
    faults = [{"settings": {"channel": "position", "axes": ["x"], "amount": 0.5}}]
    mission = {"name": "two spheres on the figure eight", "faults": faults}
    command = ["gcs", "fly", "missions/figure_eight_spheres.toml", "--seed", "3"]
    write_json(folder / "manifest.json", {"mission": mission, "seed": 3, "command": command})
    fault = {"number": 1, "kind": "bias", "vehicles": [1], "direction": None, "activations": [[3.0, 6.0]]}
    write_json(folder / "faults.json", {"take_off_s": 1.0, "faults": [fault]})
    with TableWriter(folder / "alarms.csv", ALARM_COLUMNS) as table:
        table.write([4.25, "vehicle 1", "measurements_rejected", "warning", "position"])
        table.write([4.5, "vehicle 1", "channel_isolated", "error", "position"])
    with TableWriter(folder / "phases.csv", PHASE_COLUMNS) as table:
        for time, phase in ((0.0, "connect"), (1.0, "climb"), (2.0, "fly"), (9.0, "land")):
            table.write([time, phase])
    limits = {"settle": 2.0, "clearance": 0.5, "payload_tilt_deg": 5.0}
    completed = Verdict(Outcome.COMPLETED, "", None)
    summary = summarise(read_run(folder), completed, duration_s=10.0, real_time_factor=2.0, limits=limits)
    write_json(folder / "summary.json", {**summary, "alarms": 2})
    return folder


@pytest.fixture(scope="module")
def page(folder):
    return write_report(read_run(folder))


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    with Browser(tmp_path_factory.mktemp("profile")) as browser:
        yield browser


@pytest.fixture
def shown(browser, page):
    browser.open(page)
    yield browser
    assert browser.errors == []


def test_page_says_what_happened_and_asks_for_nothing_from_a_network(shown, folder):
    assert shown.value("document.title") == "two spheres on the figure eight, seed 3: completed"
    text = shown.value("document.body.innerText")
    least = json.loads((folder / "summary.json").read_text())["clearance_min_m"]
    assert f"at least {least:.2f} m from “ball”" in text
    assert "bias (channel position, axes x, amount 0.5)" in text
    assert "first alarm 0.25 s later" in text and "position of vehicle 1 isolated after 0.50 s" in text
    assert "gcs fly missions/figure_eight_spheres.toml --seed 3" in text
    assert "Error: the payload kept within" in text
    assert shown.value("performance.getEntriesByType('resource').length") == 0


@pytest.mark.parametrize("time", [0.0, 3.33, 5.04, 10.0])
def test_slider_puts_the_payload_where_the_truth_is(shown, folder, time):
    run = read_run(folder)
    place = [float(np.interp(time, run.time, axis)) for axis in run.payload_position.T]
    shown.value(f"slider.value = {time}; slider.dispatchEvent(new Event('input'))")
    shown.frame()
    assert shown.value("report.clock.time") == pytest.approx(time, abs=0.01)
    drawn = shown.value("report.scene.payloadPixel()")
    assert drawn == pytest.approx(shown.value(f"report.scene.project({place})"), abs=1.0)
    away = [place[0], place[1] + 1.0, place[2]]
    assert np.abs(np.subtract(drawn, shown.value(f"report.scene.project({away})"))).max() > 5.0


def test_keys_move_the_clock(shown):
    def time():
        return shown.value("report.clock.time")

    shown.press("Home")
    assert time() == 0.0
    shown.press("ArrowRight")
    shown.press("ArrowRight")
    assert time() == pytest.approx(0.2)  # two rows of the truth
    shown.press("ArrowLeft")
    assert time() == pytest.approx(0.1)
    shown.press("+")
    assert shown.value("report.clock.speed") == 2
    shown.press("-")
    shown.press("-")
    assert shown.value("report.clock.speed") == 0.5
    shown.press(" ")
    assert shown.value("report.clock.playing") is True
    shown.wait("report.clock.time > 0.11")
    shown.press(" ")
    assert shown.value("report.clock.playing") is False
    shown.press("End")
    assert time() == 10.0


def test_click_on_an_alarm_moves_the_clock_and_the_cursors_of_the_plots(shown):
    shown.value("[...document.querySelectorAll('tr.event.alarm')][1].click()")
    assert shown.value("report.clock.time") == 4.5
    assert shown.value("document.querySelector('tr.current').innerText").startswith("4.50 s")
    cursors = shown.value(
        "report.plots.shown.map(({plot, cursor}) => { document.querySelector('#plots').scrollIntoView();"
        " return plot.posToVal(parseFloat(cursor.style.transform.slice(11)), 'x') })"
    )
    assert len(cursors) > 8
    shown.frame()
    shown.value("report.clock.set(6)")
    placed = shown.value(
        "report.plots.shown.filter(({visible}) => visible)"
        ".map(({plot, cursor}) => plot.posToVal(parseFloat(cursor.style.transform.slice(11)), 'x'))"
    )
    assert placed and placed == pytest.approx([6.0] * len(placed), abs=0.05)


def test_zoom_is_that_of_all_plots(shown):
    shown.value("report.plots.zoom(2, 5)")
    scales = shown.value("report.plots.shown.map(({plot}) => [plot.scales.x.min, plot.scales.x.max])")
    assert scales == [[2, 5]] * len(scales)
    # The line of the clock stays at its time.
    shown.value("report.clock.set(4)")
    shown.value("report.plots.zoom(3, 5)")
    shown.frame()
    at = "Number(cursor.style.transform.match(/[\\d.]+/)[0]) / plot.over.clientWidth"
    assert np.allclose(shown.value(f"report.plots.shown.map(({{plot, cursor}}) => {at})"), 0.5, atol=0.01)


OVERLAPS = """(() => {
  const found = [];
  const clipped = (element, rect) => {
    let {left, top, right, bottom} = rect;
    for (let e = element; e && e !== document.body; e = e.parentElement) {
      if (getComputedStyle(e).overflow === 'visible') continue;
      const box = e.getBoundingClientRect();
      left = Math.max(left, box.left); right = Math.min(right, box.right);
      top = Math.max(top, box.top); bottom = Math.min(bottom, box.bottom);
    }
    return {left, top, right, bottom};
  };
  const pieces = [];
  for (const element of document.body.querySelectorAll('*')) {
    if (element.closest('script, style, .band, svg') || !element.checkVisibility({visibilityProperty: true})) continue;
    const isControl = element.matches('button, input, canvas, .card');
    const texts = [...element.childNodes].filter((node) => node.nodeType === 3 && node.textContent.trim());
    for (const node of texts) {
      const range = document.createRange();
      range.selectNode(node);
      for (const rect of range.getClientRects()) pieces.push({element, rect: clipped(element, rect)});
    }
    if (isControl && !texts.length) pieces.push({element, rect: clipped(element, element.getBoundingClientRect())});
  }
  const name = ({element}) => `${element.tagName}.${element.className} "${element.textContent.slice(0, 30)}"`;
  const shown = pieces.filter(({rect}) => rect.right - rect.left > 1 && rect.bottom - rect.top > 1);
  for (const piece of shown) {
    if (piece.rect.left < -1 || piece.rect.right > innerWidth + 1) found.push(`${name(piece)} is beyond the edge`);
  }
  shown.forEach((a, i) => shown.slice(i + 1).forEach((b) => {
    if (a.element === b.element || a.element.contains(b.element) || b.element.contains(a.element)) return;
    if (a.element.matches('canvas') || b.element.matches('canvas')) {
      // What lies on the picture of the scene belongs there.
      if (a.element.closest('#scene') && b.element.closest('#scene')) return;
    }
    const wide = Math.min(a.rect.right, b.rect.right) - Math.max(a.rect.left, b.rect.left);
    const high = Math.min(a.rect.bottom, b.rect.bottom) - Math.max(a.rect.top, b.rect.top);
    if (wide > 1.5 && high > 2.5) found.push(`${name(a)} and ${name(b)} overlap by ${wide} x ${high}`);
  }));
  if (document.documentElement.scrollWidth > innerWidth) found.push('the page is wider than the window');
  return found;
})()"""


@pytest.mark.parametrize("size", SIZES)
def test_nothing_overlaps_or_leaves_the_page(browser, page, size):
    browser.open(page, *SIZES[size])
    browser.frame()
    assert browser.value(OVERLAPS) == []
    # The check notices what does.
    browser.value("document.querySelector('h1').style.marginBottom = '-30px'")
    browser.value("document.querySelector('.controls').style.width = '2000px'")
    assert any("overlap" in line for line in browser.value(OVERLAPS))
    assert browser.errors == []


def test_two_runs_are_compared(browser, folder):
    run = read_run(folder)
    browser.open(write_report(run, run))
    assert browser.value("report.ghost.meta.mission") == "two spheres on the figure eight"
    assert "Distance between the payloads of A and B" in browser.value("document.body.innerText")
    assert browser.errors == []


def test_run_without_truth_is_said_to_be_the_estimate(browser, folder, tmp_path):
    without = tmp_path / "without"
    without.mkdir()
    rows = (folder / "truth.csv").read_text().splitlines()
    columns = rows[0].split(",")[:14]
    extra = [f"disturbance_{axis}_n" for axis in "xyz"]
    lines = [",".join([*columns, *extra]), *(",".join([*row.split(",")[:14], "0", "0", "0"]) for row in rows[1:])]
    (without / "estimate.csv").write_text("\n".join([*lines, ""]))
    browser.open(write_report(read_run(without)))
    assert "No truth is on record" in browser.value("document.body.innerText")
    assert browser.errors == []


FLIGHT = {"kind": "forest", "fault": "", "level": 0, "severity": "", "seed": 1, "contacts": 0, "tilt_max_deg": 1.0}
FLIGHTS = [
    FLIGHT | {"name": "good", "outcome": "completed", "passed": True, "failures": "", "clearance_min_m": 0.9},
    FLIGHT | {"name": "near", "outcome": "completed", "passed": False, "failures": "clearance", "clearance_min_m": 0.2},
    FLIGHT
    | {
        "name": "hit",
        "outcome": "collided",
        "passed": False,
        "failures": "contact",
        "clearance_min_m": 0.0,
        "contacts": 1,
    },
]


def write_tables(campaign, flights):
    columns = [*flights[0]]
    lines = [",".join(columns), *(",".join(str(flight[name]) for name in columns) for flight in flights)]
    (campaign / "results.csv").write_text("\n".join([*lines, ""]))
    again = [f"{flight['name']},gcs fly missions/{flight['name']}.toml" for flight in flights]
    (campaign / "timing.csv").write_text("\n".join(["name,replay", *again, ""]))


def test_campaign_lists_the_worst_flights_first_and_links_their_pages(browser, folder, tmp_path):
    kept = tmp_path / "flights" / "hit"
    kept.parent.mkdir()
    shutil.copytree(folder, kept, ignore=shutil.ignore_patterns("*.html"))
    write_tables(tmp_path, FLIGHTS)
    browser.open(write_campaign(tmp_path))
    assert browser.value("document.title") == f"{tmp_path.name}: 1 of 3 flights passed"
    names = "[...document.querySelectorAll('#flights tbody tr')].map((row) => row.cells[0].innerText)"
    assert browser.value(names) == ["hit", "near", "good"]
    assert browser.value("[...document.querySelectorAll('a')].map((a) => a.href)") == [(kept / "report.html").as_uri()]
    assert (kept / "report.html").is_file()
    assert "1 with contacts" in browser.value("document.body.innerText")
    for size in SIZES.values():
        browser.size(*size)
        assert browser.value(OVERLAPS) == []
    assert browser.errors == []


def test_matrix_of_a_campaign_shows_the_flights_of_a_cell(browser, tmp_path):
    cells = [("loss", 1, "0.1"), ("loss", 2, "0.5"), ("bias", 1, "0.5")]
    flights = [
        flight | {"fault": fault, "level": level, "severity": severity}
        for flight, (fault, level, severity) in zip(FLIGHTS, cells, strict=True)
    ]
    write_tables(tmp_path, flights)
    browser.open(write_campaign(tmp_path))
    cells = browser.value("[...document.querySelectorAll('.cell')].map((cell) => cell.innerText.split('\\n')[1])")
    assert cells == ["1 of 1", "0 of 1", "0 of 1"]
    browser.value("document.querySelectorAll('.cell')[1].click()")
    assert browser.value("[...document.querySelectorAll('#flights tbody tr')].map((r) => r.cells[0].innerText)") == [
        "near"
    ]
    assert browser.errors == []


def test_live_page_goes_along_with_the_flight_until_it_is_over(browser, folder, tmp_path):
    for name in ("manifest.json", "obstacles.csv", "alarms.csv", "phases.csv"):
        shutil.copy(folder / name, tmp_path)
    write_until(tmp_path, folder, 0.3)
    with served(tmp_path) as (port, is_over):
        browser.open(f"http://127.0.0.1:{port}/")
        first = browser.value("report.clock.end")
        assert "in flight" in browser.value("document.querySelector('h1').innerText")
        write_until(tmp_path, folder, 0.8)
        # It goes on by itself, and what is drawn goes along.
        browser.wait(f"report.clock.end > {first} + 3 && report.clock.time > report.clock.end - 0.05")
        browser.value("report.plots.element.scrollIntoView()")
        browser.wait("report.plots.shown[0].plot.data[0].at(-1) === report.clock.end")
        assert browser.value("report.clock.following && report.scene.trail.times.at(-1) > 7")
        # Paused it stays where it is, while the flight goes on; the last key follows again.
        browser.press(" ")
        paused = browser.value("report.clock.time")
        write_until(tmp_path, folder, 1.0)
        browser.wait("report.clock.end > 9.9")
        assert browser.value("report.clock.time") == paused
        browser.press("End")
        assert browser.value("report.clock.time") == pytest.approx(10.0)
        shutil.copy(folder / "summary.json", tmp_path)
        is_over.set()
        browser.wait("report.run.meta.outcome === 'completed'")
        assert browser.value("report.run.clearance.obstacle") == "ball"
        assert "at least" in browser.value("document.body.innerText")
    assert browser.errors == []


def test_paths_of_other_lengths_and_obstacles_that_come_later_are_added_to_what_is_shown(browser, folder, tmp_path):
    """The first rows have a short path and one obstacle, the next ones a longer path and another obstacle."""
    write_truth(tmp_path, rows=31, standing=[BALL])
    with TableWriter(tmp_path / "horizon.csv", HORIZON_COLUMNS) as table:
        table.write([1.0, "plan", 0, 1.0, 0.0, -5.0])
    with served(tmp_path) as (port, _):
        browser.open(f"http://127.0.0.1:{port}/")
        with (tmp_path / "horizon.csv").open("a") as file:
            file.write("3.5,plan,0,3.5,0.0,-5.0\n3.5,plan,3,3.8,0.0,-5.0\n")
        whole = (folder / "truth.csv").read_bytes()
        with (tmp_path / "truth.csv").open("ab") as file:
            file.write(whole[file.tell() : len(whole) // 2])
        browser.wait("report.run.channel('horizon.plan').t.length === 2")
        assert browser.value("report.run.channel('horizon.plan').path(1.2)") == [[1, 0, -5]]
        assert np.allclose(browser.value("report.run.channel('horizon.plan').path(3.6)"), [[3.5, 0, -5], [3.8, 0, -5]])
        with (tmp_path / "obstacles.csv").open("a") as file:
            file.write("4.0,other,sphere,20.0,0.0,-5.0,0.5,0,0,0,0\n")
        with (tmp_path / "truth.csv").open("ab") as file:
            file.write(whole[file.tell() :])
        browser.wait("report.run.channel('clearance.each').columns.length === 2")
        each = "report.run.channel('clearance.each')"
        assert browser.value(f"{each}.columns") == ["ball", "other"]
        assert browser.value(f"{each}.series.map((values) => values.length === {each}.t.length)") == [True, True]
        assert browser.value(f"Number.isNaN({each}.series[1][0]) && {each}.series[1].at(-1) > 5")
    assert browser.errors == []
