"""Checks the links of the pages that the package bevloc installs. script/try-packages runs it:

/usr/bin/python3 -m tests.house.installed_pages FOLDER    (such as ROOT/usr/share/doc/bevloc)
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from tests.house.test_documents import local_links

PICTURE = ".png"  # no picture is installed, because they are large
LICENCE = "LICENSE"  # Debian installs its text with the name "copyright"
CONFIG = re.compile(r"(?<![\w./])config/(\w+\.(?:yaml|dbc))\b")


def broken_links(folder: Path) -> list[str]:
    """The links of all pages below the folder to files that are not there, as "page: link"."""
    broken = []
    for page in sorted(folder.rglob("*.md")):
        for link in local_links(page):
            name = link.partition("#")[0]
            if Path(name).suffix == PICTURE or Path(name).name == LICENCE:
                continue
            if not (page.parent / name).exists():
                broken.append(f"{page.relative_to(folder)}: {link}")
    return broken


def named_configs(page: Path) -> set[str]:
    """The names of the files of the folder config that the page uses."""
    return set(CONFIG.findall(page.read_text(encoding="utf-8")))


def main() -> int:
    folder = Path(sys.argv[1])
    broken = broken_links(folder)
    for link in broken:
        print(f"{folder}/{link}: found no such file, wanted one that cmake/Install.cmake installs",
              file=sys.stderr)
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
