"""From what the mission asks to a reference that can be flown."""
