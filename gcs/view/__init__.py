"""Views of a run: the report page."""
