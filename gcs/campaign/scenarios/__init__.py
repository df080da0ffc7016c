"""Random obstacle scenarios."""
