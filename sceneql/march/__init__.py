"""The march of an island in time: its driver, its loop, events, switching, stability and modes."""
