"""Kerf: split deforming solids along any crack. Arrays in, arrays out.

Reference and examples: docs/python.md.
"""
from kerf import shapes  # noqa: F401
from kerf._files import load, read_points, read_volume, reconstruct, write_level_set  # noqa: F401
from kerf._jobs import simulate  # noqa: F401
from kerf._kerf import *  # noqa: F401,F403
from kerf._kerf import __version__  # noqa: F401
from kerf._pictures import picture  # noqa: F401
from kerf import _shown  # noqa: F401
