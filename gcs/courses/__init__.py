"""Random courses, and the command that flies many of them."""
