"""One pass a file; each takes a valid whole and leaves one."""
