"""Quadratic programs: one statement of the problem, one file for each solver."""
