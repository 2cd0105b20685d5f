"""Messages say what was meant: the field, word, value or output."""
