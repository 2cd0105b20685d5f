"""Surfaces to collide with.

A file ``<shape>_kernels.py`` has the kernels ``surface``, ``bend`` and ``clear``; a collider names its shape, and
naming it compiles that file alone.
"""
