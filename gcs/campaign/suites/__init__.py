"""Suites of obstacle scenarios by other people."""
