"""From measurements to the state."""
