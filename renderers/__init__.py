"""Renderers: one word a file; a frame's plain values in, a linear picture out."""
