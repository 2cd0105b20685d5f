"""Linear systems of implicit methods: factorizations and iterations in compiled code."""
