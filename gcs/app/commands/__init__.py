"""The commands that fly many flights or none."""
