"""Sensor health: which measurements the estimator may use, and how far its own assumptions hold."""
