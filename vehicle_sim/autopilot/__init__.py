"""The onboard autopilot: modes, failsafes, attitude and position control."""
