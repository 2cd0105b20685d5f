"""Words that draw a frame; pixels and files of it."""
