"""One mission, flown with one parameter changed."""
