"""A run in the formats of other tools: ULog, and one telemetry log for each system."""
