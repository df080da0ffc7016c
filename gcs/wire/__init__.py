"""MAVLink bytes and the links that carry them."""
