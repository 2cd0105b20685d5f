"""The layout of pictures: framing, panels, lettering, plots."""
