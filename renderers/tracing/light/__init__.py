"""Light, shadow and sky at a point."""
