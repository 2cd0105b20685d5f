"""The matrix of ties: its layout, its blocks and factors, chains."""
