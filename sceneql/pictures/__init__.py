"""Layout of pictures: camera framing, panels, lettering."""
