"""The table of all kinds, and the strict reading of their parameters."""

import json
from collections.abc import Mapping
from typing import Any, get_args

from pydantic import ValidationError

from gcs.config.validate import adapter_of
from gcs.errors import UnusableInput
from gcs.faults import link, sensors, timing, values, world  # noqa: F401 -- each fills the table
from gcs.faults.kind import KINDS, Family, FaultSettings

_sorted = sorted(KINDS.items(), key=lambda item: get_args(Family).index(item[1].family))
KINDS.clear()
KINDS.update(_sorted)

__all__ = ["KINDS", "read_settings"]


def read_settings(name: str, settings: Mapping[str, Any]) -> FaultSettings:
    """Return the parameters of a fault, as the dataclass of its kind. Raises :class:`UnusableInput`."""
    if name not in KINDS:
        raise UnusableInput(f"fault: there is no kind '{name}'")
    try:
        text = json.dumps(dict(settings), default=str)
        return adapter_of(KINDS[name].settings).validate_json(text, strict=True)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(str(part) for part in first["loc"])
        raise UnusableInput(f"fault {name}: {where}: {first['msg']}") from error
    except ValueError as error:
        raise UnusableInput(f"fault {name}: {error}") from error
