"""The layout of a list of points where bodies touch, as contacts write it and groups of bodies are solved by it."""

BODY_A, BODY_B, FIRST_NAME, LAST_NAME, WHO = range(5)
"""Integers of a point: its two shapes, the first one moves; its name."""
AT_NORMAL, AT_ARM_A, AT_ARM_B, AT_GIVEN, AT_PUSH, AT_POINT, AT_LED, WHERE = 0, 3, 6, 9, 10, 13, 16, 19
"""Floats of a point: normal from b to a, arms from the centers, the normal velocity that is added (cone_rows_kernels),
the impulse on a, the point on a, the velocity there of an object b that moves by itself (else 0)."""
