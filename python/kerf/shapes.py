"""Procedural models of any resolution: closed, oriented outwards, free of self-intersection."""
from kerf._kerf._shapes import apple, block, letter, polyp, pumpkin, sphere, star

__all__ = ["apple", "block", "letter", "polyp", "pumpkin", "sphere", "star"]
