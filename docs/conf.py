# SPDX-License-Identifier: BSD-3-Clause
"""The documentation site. Its source folder is the repository: pages link to each other as they do on a Git
host, README, CONTRIBUTING and CHANGELOG among them."""

import importlib.util
import re
import sys
from pathlib import Path

from sphinx.util import logging

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "python"), str(ROOT / "docs/_site")]

project = "slipfront"
author = "the slipfront authors"
copyright = f"2026, {author}"
version = release = re.search(
    r"project\(slipfront VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
)[1]

extensions = [
    "myst_nb",
    "sphinx_external_toc",
    "sphinx.ext.autodoc",
    "sphinx_copybutton",
    "mathml",
]
include_patterns = ["docs/**", "papers/**", "verification/**", "README.md", "CONTRIBUTING.md", "CHANGELOG.md"]
exclude_patterns = ["docs/_site"]
root_doc = "docs/index"
external_toc_path = "docs/_toc.yml"

# Anchors are those that Git hosts make of headings.
myst_heading_anchors = 6
myst_enable_extensions = ["dollarmath", "amsmath"]
# A page may begin below the first level or skip one, as tables of keys do.
# A glob of the table of contents may match nothing.
suppress_warnings = ["myst.header", "etoc.glob"]
# Notebooks are shown with the output they have; a test runs them.
nb_execution_mode = "off"

autodoc_member_order = "bysource"
autodoc_typehints = "description"

html_theme = "furo"
html_title = f"slipfront {version}"
html_show_sphinx = False
html_copy_source = False
# The pages lie in docs/, as in the sources; the folder opens with them.
html_additional_pages = {"index": "redirect.html"}
templates_path = ["_site/templates"]
linkcheck_timeout = 20


def take_as_plain_text(app, what, name, object_, options, lines):
    """The docstrings are plain text: what is markup to Sphinx, such as |v|, is not meant."""
    lines[:] = [re.sub(r"([\\|*`_])", r"\\\1", line) for line in lines]


def require_the_whole_package(app, error):
    """Fails where the Python reference lacks a name of the package, as without the compiled module."""
    if error is not None or app.builder.name != "html":
        return
    import slipfront

    described = app.env.get_domain("py").objects
    missing = [name for name in slipfront.__all__ if f"slipfront.{name}" not in described]
    if missing:
        is_built = importlib.util.find_spec("slipfront._core") is not None
        reason = "" if is_built else "the compiled module slipfront._core is missing (make module): "
        logging.getLogger(__name__).error(
            f"{reason}docs/python-api.rst lacks {', '.join(missing)} of slipfront"
        )
        app.statuscode = 1


def setup(app):
    app.connect("autodoc-process-docstring", take_as_plain_text)
    app.connect("build-finished", require_the_whole_package)
