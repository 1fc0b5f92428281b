"""Checks the pages: every link resolves, every page is reached, and no source file is too long."""

from __future__ import annotations

import re
import subprocess
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
FENCE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)
SOURCES = ("*.h", "*.cpp", "*.py", "*.js", "*.css", "*.html")
MOST_LINES = 400


def tracked(*patterns: str) -> list[Path]:
    command = ["git", "ls-files", "--", *patterns]
    listed = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True)
    return [ROOT / name for name in listed.stdout.split("\n") if name]


def anchors(page: Path) -> set[str]:
    """The anchors that GitHub makes of a page's headings."""
    found = set()
    for heading in re.findall(r"^#+ (.+)$", FENCE.sub("", page.read_text()), re.MULTILINE):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        found.add(re.sub(r"[^\w\- ]", "", plain.lower()).replace(" ", "-"))
    return found


def local_links(page: Path) -> list[str]:
    links = LINK.findall(FENCE.sub("", page.read_text()))
    return [link for link in links if not re.match(r"[a-z]+:", link)]


class DocumentsTest(unittest.TestCase):
    def test_every_link_resolves(self) -> None:
        broken = []
        for page in tracked("*.md"):
            for link in local_links(page):
                name, _, anchor = link.partition("#")
                target = (page.parent / name).resolve() if name else page
                missing = not target.exists()
                if not missing and anchor and target.suffix == ".md":
                    missing = anchor not in anchors(target)
                if missing:
                    broken.append(f"{page.relative_to(ROOT)}: {link}")
        self.assertEqual(broken, [])

    def test_the_index_lists_every_page(self) -> None:
        linked = {link.partition("#")[0] for link in local_links(ROOT / "docs/README.md")}
        pages = [page for page in tracked("docs/*.md") if page.parent == ROOT / "docs"]
        missing = [page.name for page in pages if page.name not in {"README.md", *linked}]
        self.assertEqual(missing, [])

    def test_the_readme_stays_short(self) -> None:
        self.assertLess(len((ROOT / "README.md").read_text().splitlines()), 200)

    def test_no_source_file_is_too_long(self) -> None:
        long = [
            f"{path.relative_to(ROOT)}: {lines} lines"
            for path in tracked(*SOURCES)
            if path.exists() and (lines := len(path.read_text().splitlines())) > MOST_LINES
        ]
        self.assertEqual(long, [])


if __name__ == "__main__":
    unittest.main()
