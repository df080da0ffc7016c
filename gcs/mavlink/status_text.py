"""Texts of STATUSTEXT: one that is longer than a message comes in chunks."""

CHUNK = 50
"""Characters of a chunk that another follows."""
_GAP = "..."


class TextChunks:
    """Puts the chunks of a text together. One that was lost leaves dots; a text whose last was lost is not shown."""

    def __init__(self) -> None:
        self._text_id = 0
        self._chunks: dict[int, str] = {}
        self._finished = 0

    def add(self, text: str, text_id: int, number: int) -> str | None:
        """Return the whole text of which this is the last chunk, None if chunks are to follow.

        Args:
            text: the chunk.
            text_id: of the text; 0: it is one chunk.
            number: of the chunk, from 0.
        """
        if text_id == 0:
            return text
        if text_id == self._finished:  # a chunk that came twice
            return None
        if text_id != self._text_id:
            self._text_id, self._chunks = text_id, {}
        self._chunks[number] = text
        if len(text) == CHUNK:
            return None
        whole = "".join(self._chunks.get(k, _GAP) for k in range(number + 1))
        self._finished = text_id
        return whole
