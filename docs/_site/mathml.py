# SPDX-License-Identifier: BSD-3-Clause
"""Equations as MathML, which browsers draw themselves: the site needs no network and no script."""

from __future__ import annotations

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError
from sphinx.util.math import wrap_displaymath
from sphinx.writers.html5 import HTML5Translator


def mathml(latex: str, display: str) -> str:
    """The equation; text that is no LaTeX ends the build with that text."""
    try:
        return convert(latex, display=display)
    except Exception as error:
        raise ExtensionError(f"no equation: {latex!r}: {error}") from error


def visit_inline(translator: HTML5Translator, node: nodes.math) -> None:
    translator.body.append(mathml(node.astext(), "inline"))
    raise nodes.SkipNode


def visit_block(translator: HTML5Translator, node: nodes.math_block) -> None:
    latex = node.astext()
    if "\\begin{align" not in latex:
        latex = latex if node.get("no-wrap", node.get("nowrap")) else wrap_displaymath(latex, None, False)
    translator.body.append(f'<div class="math">{mathml(latex, "block")}</div>')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))
    app.config.html_math_renderer = "mathml"
    return {"parallel_read_safe": True, "parallel_write_safe": True}
