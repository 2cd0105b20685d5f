"""Ties: rows, the matrix and its factors, chains."""
