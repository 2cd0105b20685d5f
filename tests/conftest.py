"""What holds for all tests: none of them fails for taking long, since machines differ and may be busy."""

from hypothesis import settings

settings.register_profile("unhurried", deadline=None)
settings.load_profile("unhurried")
