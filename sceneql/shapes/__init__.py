"""Geometry that object words share: placement, solids and their combination, warps, wires, files of meshes."""
