"""The command line and the two drivers."""
