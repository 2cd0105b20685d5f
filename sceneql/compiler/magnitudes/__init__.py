"""Numbers that are a hundred or a thousand times off."""
