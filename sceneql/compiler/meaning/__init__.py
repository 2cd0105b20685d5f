"""What is valid, and hardly meant."""
