"""Ties: rows, the matrix of all, its factors, and chains of them."""
