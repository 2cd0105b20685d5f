"""The ray tracer: waves of rays, records, filters."""
