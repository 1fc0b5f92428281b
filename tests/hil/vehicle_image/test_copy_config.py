"""Tests that bevlocd can read the configuration of a vehicle's disk."""

import os
import pathlib
import subprocess
import tempfile
import unittest

_PROGRAM = pathlib.Path("vehicle_image/copy_config").resolve()
_USER, _GROUP = 4242, 4343


@unittest.skipIf(os.geteuid() != 0, "only root may give files to another user")
class CopyConfig(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = pathlib.Path(folder.name)
        self.config = self.work / "config"
        self.config.mkdir()
        self.copy = self.work / "copy"
        self.put("bevlocd.yaml", 0o644)

    def put(self, name: str, mode: int) -> None:
        (self.config / name).write_text(name, encoding="ascii")
        (self.config / name).chmod(mode)

    def run_program(self, config: pathlib.Path) -> subprocess.CompletedProcess[str]:
        command = ["bash", str(_PROGRAM), str(config), str(self.copy), str(_USER), str(_GROUP)]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    def expect_copied(self, config: pathlib.Path) -> None:
        done = self.run_program(config)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def owner_and_mode(self, name: str) -> tuple[int, int, int]:
        found = (self.copy / name).lstat()
        return found.st_uid, found.st_gid, found.st_mode & 0o777

    def test_gives_bevlocd_what_not_everybody_may_read(self) -> None:
        self.put("umask_027.yaml", 0o640)
        self.put("secoc.key", 0o600)
        self.config.chmod(0o700)
        self.expect_copied(self.config)
        self.assertEqual(self.owner_and_mode("bevlocd.yaml"), (0, 0, 0o644))
        self.assertEqual(self.owner_and_mode("umask_027.yaml"), (_USER, _GROUP, 0o640))
        self.assertEqual(self.owner_and_mode("secoc.key"), (_USER, _GROUP, 0o600))
        self.assertEqual(self.owner_and_mode("."), (0, 0, 0o755))

    def test_copies_what_links_point_to(self) -> None:
        (self.work / "map.bvm").write_text("map", encoding="ascii")
        (self.config / "map.bvm").symlink_to("../map.bvm")
        (self.work / "link").symlink_to("config")
        self.expect_copied(self.work / "link")
        self.assertFalse(self.copy.is_symlink())
        self.assertFalse((self.copy / "map.bvm").is_symlink())
        self.assertEqual((self.copy / "map.bvm").read_text(encoding="ascii"), "map")

    def test_refuses_a_link_to_nothing(self) -> None:
        (self.config / "map.bvm").symlink_to("../map.bvm")
        self.assertEqual(self.run_program(self.config).returncode, 1)

    def test_names_a_file_that_its_owner_may_not_read(self) -> None:
        self.put("rig.yaml", 0o040)
        refused = self.run_program(self.config)
        self.assertEqual(refused.returncode, 1)
        self.assertIn("wanted ones that bevlocd can read", refused.stderr)
        self.assertIn("./rig.yaml", refused.stderr)
        self.assertNotIn("bevlocd.yaml", refused.stderr)


if __name__ == "__main__":
    unittest.main()
