"""Layout of pictures: framing, panels, lettering."""
