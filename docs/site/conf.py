# SPDX-License-Identifier: Apache-2.0
"""Sphinx settings of the documentation site (scripts/docs): all Markdown of the repository, where it is."""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/unit/text"))
import text_rules  # noqa: E402  The suite checks the same links and anchors.

project = "dtsd"
html_title = "dtsd"
html_copy_source = False
html_show_copyright = False
html_theme = "sphinx_rtd_theme"
html_theme_options = {"navigation_depth": 2, "collapse_navigation": True}
extensions = ["myst_parser"]
myst_heading_anchors = 6
myst_heading_slug_func = text_rules.anchor_of
highlight_language = "none"
root_doc = "README"

# Titles of the contents and the folders of their documents; the first has what is in no folder.
SECTIONS = [
    ("Start", "."), ("Guides", "docs"), ("The daemon", "daemon"), ("Programs and libraries", "clients"), ("Protocol", "proto"),
    ("Configuration", "config"), ("Services", "systemd"), ("Packages", "packaging"), ("Tests", "tests"),
]
_TRACKED = subprocess.run(["git", "-C", ROOT, "ls-files", "*.md"], check=True, capture_output=True, text=True).stdout.split()
include_patterns = _TRACKED


def _contents():
    parts = []
    for title, folder in SECTIONS:
        own = [name.removesuffix(".md") for name in sorted(_TRACKED) if name != "README.md" and (name.split("/")[0] if "/" in name else ".") == folder]
        parts += ["```{toctree}", ":hidden:", f":caption: {title}", "", *own, "```", ""]
    return "\n".join(parts)


def _to_readme(document):
    """Returns a replacement for links of `document`: a folder's README, or the folder on its own where it has none."""
    folder = (ROOT / document).parent

    def replace(match):
        link = match.group(1)
        if not text_rules.SCHEME.match(link) and (folder / link).is_dir():
            readme = pathlib.PurePosixPath(link, "README.md")
            if (folder / readme).exists():
                return match.group(0).replace(f"({link}", f"({readme}")
            return re.match(r"\[([^\]]*)\]", match.group(0)).group(1)
        return match.group(0)

    return replace


def setup(app):
    def on_source(_app, document, source):
        source[0] = text_rules.LINK.sub(_to_readme(document + ".md"), source[0])
        if document == root_doc:
            source[0] += "\n" + _contents()

    app.connect("source-read", on_source)
