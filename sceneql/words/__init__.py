"""The vocabulary: one folder a family, one file a word, and the word's own kernels beside it."""
