"""The vocabulary: a folder a family, a file a word."""
