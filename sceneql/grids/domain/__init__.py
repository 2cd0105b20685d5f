"""Domains of fields: boxes, outlines, pictures and solids cut into cells."""
