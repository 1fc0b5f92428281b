"""Tests what a purge of the package bevloc deletes, and that it ends if it cannot delete all."""

import os
import pathlib
import subprocess
import tempfile
import unittest

from tests.house.test_documents import ROOT

_SCRIPT = ROOT / "debian/bevloc.postrm"
_USER = 4242


class Purge(unittest.TestCase):
    """Runs without the rights of root, because root can read and delete every file here."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for name in ("etc/bevloc/bevlocd.yaml", "var/lib/bevloc/recording/1.mcap"):
            (self.root / name).parent.mkdir(parents=True)
            (self.root / name).write_text(name, encoding="ascii")

    def purge(self) -> str:
        """Returns what the script says."""
        command = ["sh", "-c", _SCRIPT.read_text(encoding="utf-8"), "postrm", "purge"]
        if os.geteuid() == 0:
            subprocess.run(["chown", "-R", f"{_USER}:{_USER}", str(self.root)], check=True)
            user = ["setpriv", f"--reuid={_USER}", f"--regid={_USER}", "--clear-groups"]
            command = [*user, *command]
        environment = {**os.environ, "DPKG_ROOT": str(self.root), "LC_ALL": "C"}
        done = subprocess.run(
            command, env=environment, cwd="/", capture_output=True, text=True, check=False
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stderr

    def test_deletes_all_and_names_the_links(self) -> None:
        (self.root / "var/lib/bevloc/recording/disk").symlink_to("/mnt/disk")
        said = self.purge()
        self.assertIn("bevloc/recording/disk and leaves what it points to, /mnt/disk", said)
        self.assertFalse((self.root / "etc/bevloc").exists())
        self.assertFalse((self.root / "var/lib/bevloc").exists())

    def test_names_a_folder_that_cannot_be_read_and_deletes_the_rest(self) -> None:
        disk = self.root / "etc/bevloc/disk"
        disk.mkdir()
        (disk / "file").touch()
        disk.chmod(0o000)
        self.addCleanup(disk.chmod, 0o700)
        self.assertIn(f"bevloc: cannot remove {disk}; it stays", self.purge())
        self.assertFalse((self.root / "etc/bevloc/bevlocd.yaml").exists())
        self.assertFalse((self.root / "var/lib/bevloc").exists())


if __name__ == "__main__":
    unittest.main()
