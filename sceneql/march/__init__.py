"""An island stepped in time: driver, events, stability."""
