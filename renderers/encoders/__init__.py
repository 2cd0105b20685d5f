"""Encoders of pictures and films."""
