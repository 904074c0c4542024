"""Mathematics as pictures in the page: drawn when the site is built, so that readers need no script and no font."""

import html
import re
from xml.etree import ElementTree

import ziamath
from docutils import nodes
from sphinx.util import logging

SIZE = 18  # pixels of the em, beside text of 16
log = logging.getLogger(__name__)


def svg(latex):
    """A formula as an SVG element in the colour of the text around it.

    Parameters
    ----------
    latex : str     without dollar signs

    Returns
    -------
    str             how far below the line it reaches is in its style; a screen reader says the source
    """
    formula = ziamath.Latex(latex, size=SIZE, color="currentColor")
    element = formula.svgxml()
    element.set("class", "mathematics")
    element.set("role", "img")
    element.set("aria-label", latex)
    element.set("style", f"vertical-align: {formula.getyofst():.2f}px")
    return ElementTree.tostring(element, encoding="unicode")


def _drawn(node, latex):
    try:
        return svg(latex)
    except Exception as failure:
        log.warning("mathematics that cannot be drawn: %s (%s)", latex, failure, location=node)
        return f"<code>{html.escape(latex)}</code>"


def _keep_punctuation(app, doctree, docname):
    """A line may break after a picture: what must not begin a line goes with the formula before it."""
    for formula in list(doctree.findall(nodes.math)):
        after = formula.next_node(descend=False, siblings=True)
        if isinstance(after, nodes.Text) and (begins := re.match(r"[.,;:!?)’”\]-]+", after)):
            formula["after"] = begins[0]
            after.parent.replace(after, nodes.Text(after[begins.end() :]))


def _inline(self, node):
    picture = _drawn(node, node.astext())
    after = html.escape(node.get("after", ""))
    self.body.append(f'<span class="mathematics">{picture}{after}</span>' if after else picture)
    raise nodes.SkipNode


def _block(self, node):
    self.body.append(f'<div class="mathematics">{_drawn(node, node.astext())}</div>')
    raise nodes.SkipNode


def setup(app):
    """Register the renderer, for Sphinx."""
    app.connect("doctree-resolved", _keep_punctuation)
    app.add_html_math_renderer("mathematics", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
