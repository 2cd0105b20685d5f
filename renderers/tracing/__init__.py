"""The ray tracer behind the words `trace` and `normals`: packing, intersection, light, filtering, edges."""
