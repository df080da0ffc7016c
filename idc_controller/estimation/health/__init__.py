"""Which measurements may be used: innovation tests, stuck sensors, isolated channels, noise adaptation."""
