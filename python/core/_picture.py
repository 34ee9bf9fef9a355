"""Stands for the extension that draws, which a wheel of the core does not have."""
from kerf import _kerf


def __getattr__(name):
    if name.startswith("__"):
        raise AttributeError(name)
    raise _kerf.InputError("picture: not in a wheel of the core, which has no Embree; build Kerf in full (docs/python.md)")
