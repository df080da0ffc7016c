"""Random obstacle courses."""
