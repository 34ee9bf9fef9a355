"""Stands for the extension of OpenVDB and HDF5, which a wheel of the core does not have."""
from kerf import _kerf


def __getattr__(name):
    if name.startswith("__"):
        raise AttributeError(name)
    raise _kerf.InputError(f"{name}: not in a wheel of the core, which has no OpenVDB and no HDF5; build Kerf in full (docs/python.md)")
