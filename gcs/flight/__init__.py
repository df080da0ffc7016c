"""One flight from connecting to disarming."""
