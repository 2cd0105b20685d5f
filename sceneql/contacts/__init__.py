"""Contact of masses with surfaces: event location, backing off within a step, rest and friction."""
