"""Encoders: one file a format, each with a Writer."""
