"""Files of pictures and films."""
