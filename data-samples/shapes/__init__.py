"""Parametric families of shapes, one module per category of the archive."""
