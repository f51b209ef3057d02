"""Sphinx's settings; site.py gives the rest in its environment."""

import os
import sys

project = "adaptiso"
author = "the adaptiso developers"
copyright = author
version = release = os.environ["ADAPTISO_VERSION"]
extensions = ["myst_parser", "breathe", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
myst_heading_anchors = 4
nitpicky = False
html_theme = "furo"
html_title = f"adaptiso {release}"
html_show_search_summary = False  # would fetch pages, which a browser refuses to a page on disk
html_show_copyright = False
html_copy_source = False
html_static_path = ["_static"]
html_css_files = ["site.css"]
breathe_projects = {"adaptiso": os.environ["ADAPTISO_XML"]}
breathe_default_project = "adaptiso"
breathe_default_members = ("members",)
cpp_id_attributes = ["__restrict"]
highlight_language = "none"
autodoc_member_order = "bysource"
autodoc_typehints = "none"
napoleon_google_docstring = False
napoleon_use_ivar = True
sys.path.insert(0, os.environ["ADAPTISO_PYTHON"])

