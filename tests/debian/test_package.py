"""Tests what script/package leaves in the folder of the packages. The build itself is a stub."""

import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

from tests.support.stub_programs import StubPrograms

_PACKAGES = ("bevloc", "bevloc-dev", "bevloc-models", "bevloc-sim")
_BUILD = f"for name in {' '.join(_PACKAGES)}; do echo new >../${{name}}_1.0_amd64.deb; done"


@unittest.skipIf(os.geteuid() != 0, "script/package needs root")
class PackageFolder(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.out = pathlib.Path(folder.name) / "out"
        self.out.mkdir()
        tree = pathlib.Path(folder.name) / "tree"
        tree.mkdir()
        self.program = tree / "script/package"
        self.stubs = StubPrograms(self.program.parent)
        shutil.copy("script/package", self.program)
        for name, script in (
            ("bootstrap", ""),
            ("dpkg", "echo amd64"),
            ("dpkg-parsechangelog", "echo 1.0"),
            ("dpkg-buildpackage", _BUILD),
            ("lintian", ""),
        ):
            self.stubs.put(name, script)

    def put(self, name: str) -> None:
        (self.out / name).write_text("old", encoding="ascii")

    def test_has_the_new_packages_and_what_others_put_there(self) -> None:
        self.put("linux-image_6.1_amd64.deb")
        self.put("bevloc-monitor_3_all.deb")
        self.put("bevloc-sim_0.9_amd64.deb")
        command = [str(self.program), "--here", "--out", str(self.out)]
        done = subprocess.run(
            command, env=self.stubs.environment(), capture_output=True, text=True, check=False
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        made = [f"{name}_1.0_amd64.deb" for name in _PACKAGES]
        others = ["bevloc-monitor_3_all.deb", "linux-image_6.1_amd64.deb"]
        self.assertEqual(sorted(os.listdir(self.out)), sorted(made + others))
        (checked,) = [call for call in self.stubs.take_calls() if call.startswith("lintian ")]
        for name in made:
            self.assertIn(name, checked)
        for name in others:
            self.assertNotIn(name, checked + done.stdout)


if __name__ == "__main__":
    unittest.main()
