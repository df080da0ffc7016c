"""Obstacles from the points that range sensors detect: scans, tracks, the obstacle map."""
