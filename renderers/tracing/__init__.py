"""The ray tracer: rays in waves."""
