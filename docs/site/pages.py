"""Hook of mkdocs: create pages from other files.

The reference follows ``__init__.pyi``, the list of public names. README, ARCHITECTURE, CONTRIBUTING and CHANGELOG
become pages, with links changed to those of the site.
"""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[2]
# Page -> file at the top level.
PROJECT_PAGES = {
    "index.md": "README.md",
    "architecture.md": "ARCHITECTURE.md",
    "contributing.md": "CONTRIBUTING.md",
    "changelog.md": "CHANGELOG.md",
}
# Headings of the reference by room, in the order of use; a room that is not listed uses its own name.
ROOMS = {
    "case": "Study files",
    "study": "Runs and reports",
    "sweeps": "Sweeps",
    "solve": "Solver",
    "contact": "Contact",
    "structure": "Structures",
    "formats": "Files of other programs",
    "results": "Results",
    "core": "Errors",
}


def public_names() -> dict[str, list[tuple[str, str]]]:
    """Room -> (name, path of its definition), for every public name."""
    tree = ast.parse((ROOT / "src" / "stickslip" / "__init__.pyi").read_text(encoding="utf-8"))
    found: dict[str, list[tuple[str, str]]] = defaultdict(list)
    for node in tree.body:
        if isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                found[node.module.split(".")[0]].append((alias.name, f"stickslip.{node.module}.{alias.name}"))
    order = [*ROOMS, *sorted(set(found) - set(ROOMS))]
    return {room: sorted(found[room], key=lambda item: item[0].lower()) for room in order if room in found}


def title(room: str) -> str:
    """The heading of a room."""
    return ROOMS.get(room, room.replace("_", " ").capitalize())


def reference_pages() -> dict[str, str]:
    """Page -> text, for each room and the list of all names."""
    pages, rows = {}, []
    for room, names in public_names().items():
        blocks = [
            f"::: {path}\n    options:\n      heading: stickslip.{name}\n      toc_label: {name}\n"
            for name, path in names
        ]
        pages[f"reference/{room}.md"] = f"# {title(room)}\n\n" + "\n".join(blocks)
        links = ", ".join(f"[`{name}`][{path}]" for name, path in names)
        rows.append(f"| [{title(room)}]({room}.md) | {links} |")
    head = (
        "# Reference\n\nAll public names of `import stickslip as ss`. Quantities are in SI units.\n\n"
        "| page | names |\n|---|---|\n"
    )
    return {"reference/index.md": head + "\n".join(rows) + "\n", **pages}


def for_the_site(text: str) -> str:
    """Change links of a top-level file to links of the site; a target without a page loses its link."""
    pages = {source: page for page, source in PROJECT_PAGES.items()}

    def link(match: re.Match[str]) -> str:
        label, target = match.groups()
        if target.startswith(("https://", "#")):
            return match.group()
        if target.startswith("docs/"):
            return f"[{label}]({target.removeprefix('docs/')})"
        return f"[{label}]({pages[target]})" if target in pages else label

    return re.sub(r"\[([^]]*)\]\(([^)]+)\)", link, text)


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Add the generated pages to the navigation."""
    assert config.nav is not None
    rooms = [{title(room): f"reference/{room}.md"} for room in public_names()]
    project = [page for page in PROJECT_PAGES if page != "index.md"]
    config.nav += [{"Reference": ["reference/index.md", *rooms]}, {"Project": project}]
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages."""
    texts: dict[str, Any] = dict(reference_pages())
    for page, source in PROJECT_PAGES.items():
        texts[page] = for_the_site((ROOT / source).read_text(encoding="utf-8"))
    for page, text in texts.items():
        files.append(File.generated(config, page, content=text))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Change links from docs/ to top-level files into links to their pages."""
    for target, source in PROJECT_PAGES.items():
        markdown = markdown.replace(f"](../{source})", f"]({target})")
    return markdown
