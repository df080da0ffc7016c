"""Surfaces fitted to points."""
