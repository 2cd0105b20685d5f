"""Densities of skeletons: values, gradients and enclosures."""
