"""Fields on grids as pictures see them: interpolated, on sheets of triangles, in colors."""
