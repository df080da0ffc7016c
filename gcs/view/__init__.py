"""Views of missions and runs; nothing that flies imports this package."""
