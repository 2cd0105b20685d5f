"""sceneql: a compiler from scene scripts to films."""

__version__ = "0.1.0"
