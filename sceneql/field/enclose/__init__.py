"""Enclosures of tapes: intervals and first-order forms over boxes and along rays."""
