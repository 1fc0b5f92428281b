"""Checks the software bill of materials of the program that BEVLOC_PROGRAM names (script/sbom)."""

from __future__ import annotations

import json
import os
import re
import subprocess
import unittest
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("BEVLOC_PROGRAM", ROOT / "build/release/bin/bevlocd"))


def output_of(*command: str) -> str:
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def values(component: dict[str, Any], name: str) -> list[str]:
    return [p["value"] for p in component["properties"] if p["name"] == name]


class SbomTest(unittest.TestCase):
    bill: dict[str, Any]

    @classmethod
    def setUpClass(cls) -> None:
        cls.bill = json.loads(output_of(str(ROOT / "script/sbom"), str(PROGRAM)))

    def test_it_is_a_cyclonedx_document(self) -> None:
        self.assertEqual((self.bill["bomFormat"], self.bill["specVersion"]), ("CycloneDX", "1.4"))
        self.assertRegex(self.bill["serialNumber"], r"^urn:uuid:[0-9a-f-]{36}$")
        refs = [c["bom-ref"] for c in self.bill["components"]]
        self.assertEqual(len(refs), len(set(refs)))
        self.assertEqual(self.bill["dependencies"][0]["dependsOn"], refs)

    def test_it_names_the_program(self) -> None:
        program = self.bill["metadata"]["component"]
        self.assertEqual(program["name"], PROGRAM.name)
        self.assertEqual(program["version"], output_of(str(PROGRAM), "--version").split()[-1])
        self.assertEqual(program["hashes"][0]["content"],
                         output_of("sha256sum", str(PROGRAM)).split()[0])

    def test_it_names_every_library_that_the_program_needs(self) -> None:
        dynamic = output_of("readelf", "-d", str(PROGRAM))
        needed = set(re.findall(r"\(NEEDED\).*\[(.+)\]", dynamic))
        self.assertGreater(len(needed), 10)
        listed = {name for c in self.bill["components"] for name in values(c, "bevloc:file")}
        self.assertEqual(needed - listed, set())

    def test_it_names_libraries_of_headers(self) -> None:
        headers = {c["name"] for c in self.bill["components"]
                   if values(c, "bevloc:linkage") == ["headers"]}
        self.assertLessEqual({"libeigen3-dev", "libexpected-dev", "libcli11-dev"}, headers)

    def test_versions_are_those_of_the_installed_packages(self) -> None:
        for component in self.bill["components"]:
            if component["type"] != "library":
                continue
            name = component["name"]
            installed = output_of("dpkg-query", "-W", "-f=${Version}\n", name).split()
            self.assertIn(component["version"], installed, name)
        licensed = [c for c in self.bill["components"] if c.get("licenses")]
        self.assertGreater(len(licensed), len(self.bill["components"]) // 2)


if __name__ == "__main__":
    unittest.main()
