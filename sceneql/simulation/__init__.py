"""Graph to frames: the run, the islands, and the families of words."""
