"""Kerf by its Python module."""

import importlib
import sys


def find(folder=""):
    return None
