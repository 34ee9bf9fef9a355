"""Settings of Sphinx for the reference of the module kerf: docs/python.md, "Samples and types".

The pages list classes and functions; their text is that of the docstrings. A public name that no page lists is a warning.
"""
from __future__ import annotations

import inspect
import re
import types
from typing import Any

import kerf
from sphinx.util import logging

project = "Kerf"
version = release = kerf.__version__
extensions = ["sphinx.ext.autodoc"]
html_theme = "alabaster"
html_theme_options = {"description": "Splits deforming solids along any crack", "page_width": "70em", "sidebar_width": "14em"}
html_show_copyright = False
html_show_sourcelink = False
autodoc_default_options = {"members": True}
autodoc_member_order = "groupwise"
add_module_names = False


def as_written(app: Any, what: str, name: str, obj: object, options: object, lines: list[str]) -> None:
    """Docstrings are plain text: characters that reStructuredText gives a meaning are escaped."""
    lines[:] = [re.sub(r"([*`|_\\])", r"\\\1", line).strip() for line in lines]


def short_signature(app: Any, what: str, name: str, obj: object, options: object, signature: str | None, returns: str | None) -> tuple[str | None, str | None]:
    """Without the inner module, and without types that say nothing: shapes and types are in the text and in the .pyi."""
    def shortened(text: str) -> str:
        text = re.sub(r"kerf\._kerf\.", "", text)
        text = re.sub(r"\(self(: \w+)?(, )?", "(", text)
        return re.sub(r": object\b|\*\*kwargs", lambda found: "**options" if "kwargs" in found[0] else "", text)

    return (None if signature is None else shortened(signature)), (None if returns in (None, "object") else shortened(str(returns)))


def all_listed(app: Any, error: Exception | None) -> None:
    """Warns of each public name of the module that no page lists."""
    if error:
        return
    listed = set(app.env.get_domain("py").objects)
    for name, value in vars(kerf).items():
        private = name.startswith("_") or isinstance(value, types.ModuleType)
        if not private and (callable(value) or inspect.isclass(value)) and f"kerf.{name}" not in listed:
            logging.getLogger("reference").warning("kerf.%s is in no page of docs/python", name)


def setup(app: Any) -> None:
    app.connect("autodoc-process-docstring", as_written)
    app.connect("autodoc-process-signature", short_signature)
    app.connect("build-finished", all_listed)
