"""The team as one MAVLink aircraft: its orders, its plans, and what it reports, on the services of an aircraft."""
