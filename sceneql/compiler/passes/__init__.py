"""One pass a file, valid to valid."""
