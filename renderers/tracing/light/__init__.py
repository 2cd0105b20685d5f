"""Light at a surface point: visibility, sampling, shading."""
