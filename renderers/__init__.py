"""Words that draw a frame; its pixels developed."""
