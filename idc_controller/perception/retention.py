"""How long a followed obstacle outlives not being seen."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from idc_controller.perception.track import Track

GHOST_AFTER = 1.0  # s unseen, although in range
FORGET_AFTER = 2.0  # s unseen and out of range, if it moves
UNCONFIRMED_AFTER = 0.5  # s
GHOST_DOUBTED = 3.0  # s for which one that was not seen may still have been there: the sensors may prove to be blind


class Unseen:
    """Remembers the ghosts: what was believed, and was not where vehicles could not have missed it."""

    def __init__(self) -> None:
        self._ghosts: list[tuple[float, Track]] = []

    def left(
        self, tracks: Sequence[Track], now: float, blind: bool, could_see: Callable[[Track], bool]
    ) -> tuple[list[Track], list[str]]:
        """The tracks that are kept at ``now`` (s), and the names of those that vanished.

        ``blind``: no vehicle sees anything; then nothing is forgotten. ``could_see``: whether a vehicle could not miss
        it.
        """
        self._ghosts = [(when, track) for when, track in self._ghosts if now - when <= GHOST_DOUBTED]
        if blind:
            return self._kept(tracks), []
        left, vanished = [], []
        for track in tracks:
            silent = now - track.last_seen
            is_known = track.known is not None
            if silent <= UNCONFIRMED_AFTER or track.is_kept or (is_known and track.is_gone):
                left.append(track)
            elif not track.is_believed:
                pass
            elif silent > GHOST_AFTER and could_see(track):
                vanished.append(track.name)
                self._ghosts.append((now, track))
                if is_known:
                    track.is_gone = True
                    left.append(track)
            elif is_known or track.is_static or silent <= FORGET_AFTER:
                left.append(track)
        return left, vanished

    def _kept(self, tracks: Sequence[Track]) -> list[Track]:
        """What was believed before the sensors proved to be blind; what they did not see since is no ghost."""
        back = []
        for _, track in self._ghosts:
            track.is_gone = False
            if track not in tracks:
                back.append(track)
        self._ghosts.clear()
        kept = [*tracks, *back]
        for track in kept:
            track.is_kept = track.is_kept or track.is_believed
        return kept
