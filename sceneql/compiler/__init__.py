"""Tree to graph: the catalogue of words, the checker, the passes. Meets words only through the catalogue, as kinds."""
