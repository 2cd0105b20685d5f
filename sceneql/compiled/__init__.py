"""Kernels: decorator, cache, threads, generated code."""
