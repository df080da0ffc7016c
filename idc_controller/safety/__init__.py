"""The safety filter: a planned trajectory that keeps obstacles out of the hull of the formation."""
