"""Sphinx's settings: `build.py` beside this file lays out the pages and calls it."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import framework

project, author = "Real-time environment mapping", "the authors of the course"
version = release = framework.__version__
copyright = "the authors, MIT licence"
root_doc = "README"
exclude_patterns = ["assignments/**/*.md"]  # licences: linked to as files
extensions = ["sphinx.ext.autodoc", "numpydoc", "myst_nb", "mathematics", "docstrings"]

myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 3
myst_links_external_new_tab = True
nb_execution_mode = "off"  # the outputs are in the notebooks
nb_merge_streams = True
suppress_warnings = ["myst.header"]  # a notebook's cells may begin below the first heading

default_role = "code"
autodoc_member_order = "bysource"
autodoc_typehints = "none"
numpydoc_show_class_members = False
numpydoc_xref_param_type = False
add_module_names = False
html_math_renderer = "mathematics"

html_theme = "furo"
html_title = "Real-time environment mapping"
html_static_path = ["site.css"]
html_css_files = ["site.css"]
html_show_sphinx = False
html_show_search_summary = False  # excerpts would be fetched, which a browser refuses from disk
html_copy_source = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#0b5cad", "color-brand-content": "#0b5cad"},
    "dark_css_variables": {"color-brand-primary": "#7db8f2", "color-brand-content": "#7db8f2"},
}
pygments_style, pygments_dark_style = "friendly", "github-dark"
