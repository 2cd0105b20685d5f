"""Point masses and nets of springs: state, pins, tears, emitters, and how they look."""
