"""Compiled code: the kernel decorator, its cache, threads, lanes, generated modules."""
