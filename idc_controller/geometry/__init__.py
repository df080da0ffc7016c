"""Shapes, the formation, and the distances between them."""
