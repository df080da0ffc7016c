"""What the ground knows of obstacles: those on the map, and those that the vehicles' range sensors find."""
