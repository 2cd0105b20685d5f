"""Renderers, the words that draw a frame, and the development of pixels."""
