"""A film of a run: its report page, frame by frame, in a browser without a screen, encoded by ffmpeg."""

import json
import subprocess
import tempfile
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gcs.errors import GcsError, UnusableInput
from gcs.extras import extra
from gcs.record.run_data import RunData
from gcs.view.browser import Browser, find_browser
from gcs.view.page import report_text, write_page

FILM = "film.mp4"
CAMERAS = {"follow": "follow", "overview": "free", "top": "top"}
"""Names of the cameras of the page's scene."""
ENCODERS = {
    ".mp4": ["-c:v", "libx264", "-preset", "veryfast", "-crf", "23", "-pix_fmt", "yuv420p", "-movflags", "+faststart"],
    ".webp": ["-c:v", "libwebp", "-quality", "60", "-compression_level", "4", "-loop", "0"],
    ".gif": ["-filter_complex", "split[a][b];[a]palettegen=max_colors=96[p];[b][p]paletteuse=dither=none"],
}
"""Options of ffmpeg by the suffix of the file."""
SIZES = range(160, 4097)  # pixels
MOST_FRAMES_A_SECOND = 60

# The scene fills the window, with title and time over it, without controls.
_STYLE = """
#page { max-width: none; padding: 0; }
#page > :not(header, .top), .cards, .scene-cameras, .scene-key { display: none !important; }
#page > .top { display: block; height: auto; }
#page > header { position: fixed; z-index: 30; top: 10px; left: 14px; }
#page > header h1 { font-size: 18px; }
#film-time { position: fixed; z-index: 30; top: 10px; right: 14px;
  font-weight: 600; font-variant-numeric: tabular-nums; }
#scene { position: fixed; inset: 0; width: auto; height: auto; border: none; border-radius: 0; }
"""


@dataclass(frozen=True)
class FilmSettings:
    """What is shown, and how. Times are those of the run (s); ``None`` is its begin or end.

    Raises :class:`UnusableInput` at a value with which no film can be made.
    """

    start: float | None = None
    end: float | None = None
    speed: float = 1.0
    """Seconds of the flight in one of the film."""
    size: tuple[int, int] = (1280, 720)
    """Width and height (pixels), both even: the encoder halves the resolution of colours."""
    fps: int = 25
    camera: str | None = None
    """One of :data:`CAMERAS`; ``None`` is the one that the page chooses."""

    def __post_init__(self) -> None:
        if not (np.isfinite(self.speed) and self.speed > 0):
            raise UnusableInput(f"--speed {self.speed:g}: must be above 0")
        if not 1 <= self.fps <= MOST_FRAMES_A_SECOND:
            raise UnusableInput(f"--fps {self.fps}: must be 1 to {MOST_FRAMES_A_SECOND}")
        if any(length not in SIZES or length % 2 for length in self.size):
            width, height = self.size
            raise UnusableInput(f"--size {width}x{height}: must be even numbers from {SIZES[0]} to {SIZES[-1]}")

    def times(self, run: RunData) -> np.ndarray:
        """Return the times of the frames (s), shape (frames,). Raises :class:`UnusableInput` where there are none."""
        if len(run.time) == 0:
            raise UnusableInput(f"{run.folder}: nothing was flown: there is no row in truth.csv or estimate.csv")
        first, last = float(run.time[0]), float(run.time[-1])
        start = first if self.start is None else self.start
        end = last if self.end is None else self.end
        for option, value in (("--from", start), ("--to", end)):
            if not first <= value <= last:
                raise UnusableInput(f"{option} {value:g}: the flight is from {first:g} to {last:g} s")
        if start >= end:
            raise UnusableInput(f"--from {start:g}: must be before --to {end:g}")
        return start + np.arange(max(1, round((end - start) / self.speed * self.fps))) * self.speed / self.fps


def write_film(run: RunData, settings: FilmSettings, out: Path | None = None) -> Path:
    """Write a film of a run to ``out`` (default: into its folder), and return its path.

    Raises :class:`UnusableInput` where browser or encoder are missing, or settings or path cannot be used, and
    :class:`GcsError` where one of them fails. A file appears only when it is whole.
    """
    out = run.folder / FILM if out is None else out
    if out.suffix not in ENCODERS:
        raise UnusableInput(f"--out {out}: must end in {', '.join(ENCODERS)}")
    if not out.parent.is_dir():
        raise UnusableInput(f"--out {out}: there is no folder {out.parent}")
    times = settings.times(run)
    with extra("film", "gcs film"):
        from imageio_ffmpeg import get_ffmpeg_exe
    program = find_browser()
    if program is None:
        raise UnusableInput("gcs film: needs Chromium or Chrome (Debian, Ubuntu: apt-get install chromium)")
    part = out.with_name(f".{out.stem}.part{out.suffix}")
    try:
        with tempfile.TemporaryDirectory(prefix="gcs-film-", ignore_cleanup_errors=True) as folder:
            page = write_page(Path(folder) / "report.html", report_text([run]))
            with Browser(program, Path(folder) / "profile") as browser:
                _show(browser, page, settings)
                _encode(browser, times, settings.fps, get_ffmpeg_exe(), part)
        part.replace(out)
    except OSError as error:
        raise UnusableInput(f"{out}: cannot be written: {error.strerror}") from None
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)
    return out


def _show(browser: Browser, page: Path, settings: FilmSettings) -> None:
    browser.open(page, *settings.size)
    if not browser.value("Boolean(window.report?.scene)"):
        raise GcsError(f"gcs film: the browser does not show the page: {'; '.join(browser.errors)}")
    camera = "" if settings.camera is None else f"report.scene.setCamera({json.dumps(CAMERAS[settings.camera])});"
    browser.value(
        f"const style = document.createElement('style'); style.textContent = {json.dumps(_STYLE)};"
        "const time = document.createElement('div'); time.id = 'film-time'; document.head.append(style);"
        "document.body.append(time); document.querySelector('.scene-key').open = false;"
        f"report.scene.resize(); {camera}"
        "window.filmFrame = (t) => { time.textContent = t.toFixed(1) + ' s'; report.scene.renderAt(t); };"
    )
    browser.frame()


def _encode(browser: Browser, times: np.ndarray, fps: int, ffmpeg: str, path: Path) -> None:
    command = [
        ffmpeg, "-y", "-loglevel", "error", "-threads", "1", "-f", "image2pipe", "-framerate", str(fps), "-c:v",
        "mjpeg", "-i", "-", *ENCODERS[path.suffix], str(path),
    ]  # fmt: skip
    with tempfile.TemporaryFile() as said:
        encoder = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=said, start_new_session=True)
        assert encoder.stdin is not None
        try:
            with suppress(BrokenPipeError), encoder.stdin as frames:
                for time in times:
                    browser.value(f"filmFrame({time:.6f})")
                    frames.write(browser.picture(format="jpeg", quality=90, optimizeForSpeed=True))
            status = encoder.wait()
        finally:
            if encoder.poll() is None:
                encoder.kill()
                encoder.wait()
        if status != 0:
            said.seek(0)
            raise GcsError(f"gcs film: ffmpeg: {said.read().decode(errors='replace').strip() or f'status {status}'}")
