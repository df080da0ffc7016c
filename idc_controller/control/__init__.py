"""From state and reference to set-points."""
