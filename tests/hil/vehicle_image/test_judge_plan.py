"""Tests which updates a vehicle refuses, with what apt prints."""

import pathlib
import subprocess
import tempfile
import unittest

_PROGRAM = pathlib.Path("vehicle_image/files/usr/libexec/bevloc-image/judge-plan").resolve()
_NEWER = """Calculating upgrade...
The following packages will be upgraded:
  bevloc bevloc-models
2 upgraded, 0 newly installed, 0 to remove and 0 not upgraded.
Inst bevloc [0.1.0] (9.0.2 localhost [amd64])
Inst bevloc-models [0.1.0] (0.2.0 localhost [amd64])
Conf bevloc (9.0.2 localhost [amd64])
Conf bevloc-models (0.2.0 localhost [amd64])
"""
_NOTHING = """Calculating upgrade...
0 upgraded, 0 newly installed, 0 to remove and 0 not upgraded.
"""
_KEPT_BACK = """Calculating upgrade...
The following packages have been kept back:
  bevloc bevloc-models
0 upgraded, 0 newly installed, 0 to remove and 2 not upgraded.
"""
_PARTLY_KEPT_BACK = """Calculating upgrade...
The following packages have been kept back:
  bevloc
The following packages will be upgraded:
  bevloc-models
1 upgraded, 0 newly installed, 0 to remove and 1 not upgraded.
Inst bevloc-models [0.1.0] (0.2.0 localhost [amd64])
Conf bevloc-models (0.2.0 localhost [amd64])
"""
_REMOVING = """Calculating upgrade...
Remv libx [1]
Inst bevloc [0.1.0] (9.0.2 localhost [amd64])
Conf bevloc (9.0.2 localhost [amd64])
"""


class JudgePlan(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.entries = pathlib.Path(folder.name)

    def judge(self, plan: str, again: str = "") -> subprocess.CompletedProcess[str]:
        command = ["bash", str(_PROGRAM), str(self.entries / "bevloc-b"), "0.1.0", again]
        return subprocess.run(command, input=plan, capture_output=True, text=True, check=False)

    def expect_accepted(self, plan: str, again: str = "") -> str:
        judged = self.judge(plan, again)
        self.assertEqual((judged.returncode, judged.stdout), (0, ""))
        return judged.stderr

    def expect_refused(self, reason: str, plan: str) -> None:
        judged = self.judge(plan)
        self.assertEqual((judged.returncode, judged.stderr), (1, ""))
        self.assertIn(reason, judged.stdout)
        self.assertEqual(len(judged.stdout.splitlines()), 1)

    def put_entry(self, name: str, version: str) -> None:
        text = f"title bevloc {version}\nsort-key bevloc\nversion 2\n"
        (self.entries / name).write_text(text, encoding="ascii")

    def test_accepts_newer_packages(self) -> None:
        self.assertEqual(self.expect_accepted(_NEWER), "")

    def test_refuses_when_nothing_is_newer(self) -> None:
        self.expect_refused("found no packages that are newer", _NOTHING)

    def test_names_packages_that_are_kept_back(self) -> None:
        self.expect_refused("keeps back (bevloc bevloc-models)", _KEPT_BACK)
        said = self.expect_accepted(_PARTLY_KEPT_BACK)
        self.assertEqual(said, "apt keeps these packages back: bevloc\n")

    def test_refuses_to_remove_packages(self) -> None:
        self.expect_refused("removes packages (libx)", _REMOVING)

    def test_refuses_a_version_that_failed_its_trial(self) -> None:
        self.put_entry("bevloc-b+0-3.conf", "9.0.2")
        self.expect_refused("bevloc 9.0.2 failed its trial", _NEWER)
        self.expect_accepted(_NEWER, "again")

    def test_refuses_a_version_that_waits_for_a_restart(self) -> None:
        for name in ("bevloc-b+10.conf", "bevloc-b+9-1.conf"):
            with self.subTest(name):
                self.put_entry(name, "9.0.2")
                self.expect_refused("bevloc 9.0.2 is installed and waits for a restart", _NEWER)
                self.expect_accepted(_NEWER, "again")
                (self.entries / name).unlink()

    def test_accepts_another_version_than_the_one_that_failed(self) -> None:
        self.put_entry("bevloc-b+0-3.conf", "9.0.20")
        self.put_entry("bevloc-b.conf", "9.0.2")
        self.put_entry("bevloc-a+0-3.conf", "9.0.2")
        self.expect_accepted(_NEWER)

    def test_knows_a_failed_update_of_other_packages_by_the_version_that_stays(self) -> None:
        self.put_entry("bevloc-b+0-3.conf", "0.1.0")
        judged = self.judge(_PARTLY_KEPT_BACK)
        self.assertEqual(judged.returncode, 1)
        self.assertIn("bevloc 0.1.0 failed its trial", judged.stdout)


if __name__ == "__main__":
    unittest.main()
