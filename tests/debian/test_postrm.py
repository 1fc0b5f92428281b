"""Tests what `apt purge bevloc` deletes, in a folder that stands for the root."""

import os
import pathlib
import subprocess
import tempfile
import unittest

_SCRIPT = pathlib.Path("debian/bevloc.postrm").resolve()


def _may_mount() -> bool:
    done = subprocess.run(["unshare", "--mount", "true"], check=False, capture_output=True)
    return done.returncode == 0


class Purge(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.state = self.root / "var/lib/bevloc"
        self.put("etc/bevloc/bevlocd.yaml")
        self.put("var/lib/bevloc/recording/1.mcap")

    def put(self, name: str) -> pathlib.Path:
        file = self.root / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(name, encoding="ascii")
        return file

    def run_script(self, word: str, *before: str) -> str:
        """Runs the script, which must succeed, and returns what it says."""
        done = subprocess.run(
            [*before, "sh", str(_SCRIPT), word],
            env={**os.environ, "DPKG_ROOT": str(self.root)},
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
        return done.stderr

    def test_leaves_nothing(self) -> None:
        self.assertEqual(self.run_script("purge"), "")
        self.assertEqual(list(self.root.rglob("*bevloc*")), [])

    def test_removal_leaves_all(self) -> None:
        self.assertEqual(self.run_script("remove"), "")
        self.assertTrue((self.state / "recording/1.mcap").exists())
        self.assertTrue((self.root / "etc/bevloc/bevlocd.yaml").exists())

    def test_removes_links_and_leaves_what_they_point_to(self) -> None:
        log = self.put("disk/log/bevlocd.log")
        drive = self.put("disk/drives/2.mcap")
        (self.root / "var/log").mkdir()
        (self.root / "var/log/bevloc").symlink_to(log.parent)
        (self.state / "drives").symlink_to(drive.parent)
        said = self.run_script("purge")
        self.assertEqual(list(self.root.rglob("*/bevloc")), [])
        self.assertTrue(log.exists())
        self.assertTrue(drive.exists())
        for target in (log.parent, drive.parent):
            self.assertIn(str(target), said)

    @unittest.skipUnless(os.geteuid() == 0 and _may_mount(), "only root may mount a disk")
    def test_deletes_the_files_of_a_mounted_disk_and_leaves_its_root(self) -> None:
        disk = self.state / "recording"
        script = (
            f"mount -t tmpfs tmpfs '{disk}'; mkdir '{disk}/old'; echo drive >'{disk}/old/2.mcap';"
            f'"$@" && ls -A "{disk}" >&2'
        )
        said = self.run_script("purge", "unshare", "--mount", "sh", "-c", script, "sh")
        self.assertFalse((self.root / "etc/bevloc").exists())
        lines = [line for line in said.splitlines() if str(self.state) in line]
        self.assertEqual(lines, said.splitlines(), "the disk has files")
        self.assertIn(str(disk), said)
        self.assertNotIn("2.mcap", said)


if __name__ == "__main__":
    unittest.main()
