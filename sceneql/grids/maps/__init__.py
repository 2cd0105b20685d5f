"""Fields as pictures show them."""
