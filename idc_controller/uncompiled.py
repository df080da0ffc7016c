"""What is done about kernels whose machine code is not on disk; imports nothing, programs set it at once."""

from collections.abc import Callable

compile_all: Callable[[], None] | None = None
"""Called at the first such kernel of the process, which then is looked for on disk again; None: each is compiled."""
