"""Tapes: straight-line code of implicit fields, its construction and evaluation."""
