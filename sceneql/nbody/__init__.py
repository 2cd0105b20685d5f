"""Forces of 1/r^2 between all masses: sums, trees."""
