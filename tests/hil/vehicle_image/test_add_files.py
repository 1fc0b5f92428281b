"""Tests how a user's files get into the root of a vehicle's disk."""

import os
import pathlib
import subprocess
import tempfile
import unittest

_PROGRAM = pathlib.Path("vehicle_image/add_files").resolve()


class AddFiles(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.extra = pathlib.Path(folder.name) / "extra"
        self.root = pathlib.Path(folder.name) / "root"
        (self.extra / "etc").mkdir(parents=True)
        (self.root / "etc").mkdir(parents=True)

    def run_program(self) -> None:
        subprocess.run(["bash", str(_PROGRAM), str(self.extra), str(self.root)], check=True)

    def test_keeps_the_links_of_debian(self) -> None:
        for name in ("bin", "lib", "sbin"):
            (self.root / "usr" / name).mkdir(parents=True)
            (self.root / "usr" / name).chmod(0o755)
            (self.root / name).symlink_to(f"usr/{name}")
            (self.extra / name).mkdir()
            (self.extra / name).chmod(0o700)
            (self.extra / name / "own").write_text(name, encoding="ascii")
        (self.root / "usr/bin/init").write_text("init", encoding="ascii")
        self.run_program()
        for name in ("bin", "lib", "sbin"):
            self.assertEqual(os.readlink(self.root / name), f"usr/{name}")
            self.assertEqual((self.root / "usr" / name).stat().st_mode & 0o777, 0o755)
            self.assertEqual((self.root / "usr" / name / "own").read_text(encoding="ascii"), name)
        self.assertTrue((self.root / "bin/init").exists())

    def test_keeps_the_modes_of_files_and_of_folders_that_are_there(self) -> None:
        (self.root / "etc").chmod(0o755)
        (self.extra / "etc").chmod(0o700)
        (self.extra / "etc/key").write_text("key", encoding="ascii")
        (self.extra / "etc/key").chmod(0o600)
        (self.extra / "own").mkdir()
        (self.extra / "own").chmod(0o750)
        self.run_program()
        for name, mode in (("etc", 0o755), ("own", 0o750), ("etc/key", 0o600)):
            self.assertEqual((self.root / name).stat().st_mode & 0o777, mode, name)


if __name__ == "__main__":
    unittest.main()
