"""Retention of tracks without detections: coasting, deletion, and restoration when obstacle sensing was lost."""

from collections.abc import Callable, Sequence

from idc_controller.perception.settings import RetentionSettings
from idc_controller.perception.track import Track


class TrackRetention:
    """Decides which tracks are kept; remembers the deleted ones for a while. Times are the team's (s)."""

    def __init__(self, settings: RetentionSettings | None = None) -> None:
        self._settings = settings or RetentionSettings()
        self._deleted: list[tuple[float, Track]] = []

    def retain(
        self, tracks: Sequence[Track], now: float, sensing_lost: bool, in_field_of_view: Callable[[Track], bool]
    ) -> tuple[list[Track], list[str]]:
        """Return the tracks that are kept at ``now`` (s), and the names of confirmed ones that are deleted.

        Args:
            tracks: all tracks.
            now: s.
            sensing_lost: whether no vehicle can detect obstacles; then nothing is deleted.
            in_field_of_view: whether a vehicle would certainly detect a track.
        """
        s = self._settings
        self._deleted = [(since, track) for since, track in self._deleted if now - since <= s.restorable]
        if sensing_lost:
            return self._restored(tracks), []
        kept, deleted = [], []
        for track in tracks:
            silence = now - track.last_detected
            on_map = track.map_shape is not None
            if silence <= s.tentative_time or track.is_retained or (on_map and track.is_deleted):
                kept.append(track)
            elif not track.is_confirmed:
                pass
            elif silence > s.delete_after and in_field_of_view(track):
                deleted.append(track.name)
                self._deleted.append((now, track))
                if on_map:
                    track.is_deleted = True
                    kept.append(track)
            elif on_map or track.is_static or silence <= s.forget_after:
                kept.append(track)
        return kept, deleted

    def _restored(self, tracks: Sequence[Track]) -> list[Track]:
        """Return the tracks confirmed before obstacle sensing was lost, with those that were deleted meanwhile."""
        restored = []
        for _, track in self._deleted:
            track.is_deleted = False
            if track not in tracks:
                restored.append(track)
        self._deleted.clear()
        kept = [*tracks, *restored]
        for track in kept:
            track.is_retained = track.is_retained or track.is_confirmed
        return kept
