"""A mission planned on ideal tracking, without physics, MAVLink and estimator; its undisturbed schedule."""
