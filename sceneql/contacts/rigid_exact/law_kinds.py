"""Kinds of rows of the dense system of exact contacts and ties (exact_law_kernels)."""

BILATERAL, UNILATERAL, NORMAL, ACROSS, ALONG, BOUNDED, MOMENT, SECOND, THIRD = range(9)
"""Kinds of rows: a tie; a contact whose friction is known by its normal force; one of three rows of a contact with
Coulomb's cone; one between bounds of its own; one of three of a moment. Behind the kinds of all rows stands of each
moment's row that of the normal force which bounds it."""
