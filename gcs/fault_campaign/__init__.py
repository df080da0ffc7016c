"""Campaigns of faults: faults x severities x missions x seeds, each flown, all told in one table."""
