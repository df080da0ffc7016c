"""The data of the report page, decoded as ``gcs/view/page/data.js`` does."""

import base64
import zlib

import numpy as np


class Decoded:
    """A run as ``data.js`` decodes it."""

    def __init__(self, header, blob):
        self.header, self._data = header, zlib.decompress(base64.b64decode(blob))

    def channel(self, name):
        """Times (T,) and values (T, ...) of a channel."""
        entry = self.header["channels"][name]
        return times_of(self._data, entry["t"]), values_of(self._data, entry["values"])


def times_of(data, reference):
    steps = np.frombuffer(data, "<i4", reference["shape"][0], reference["offset"])
    return (reference["first"] + np.cumsum(steps)) / 1e6


def values_of(data, reference):
    rows, columns = reference["shape"][0], int(np.prod(reference["shape"][1:]))
    kind = "<f4" if reference["dtype"] == "float32" else "<u2"
    stored = np.frombuffer(data, kind, rows * columns, reference["offset"]).reshape(columns, rows)
    if kind == "<u2":
        whole = np.cumsum(stored.astype(np.int64), axis=1) % 65536
        first, scale = (np.array(reference[name])[:, None] for name in ("first", "scale"))
        stored = np.where(whole == 65535, np.nan, first + scale * whole)
    return stored.T.reshape(reference["shape"])
