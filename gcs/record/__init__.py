"""Records of a flight: its run folder, summary and pictures."""
