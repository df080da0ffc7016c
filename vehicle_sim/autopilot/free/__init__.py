"""The autopilot of a vehicle without a payload: PX4's modes, flown by a vehicle for itself."""
