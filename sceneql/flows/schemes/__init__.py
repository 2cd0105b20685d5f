"""Steps of flows."""
