"""The safety filter: the formation's hull, exponential barriers on it, and plans that keep them."""
