"""Tests why a guest that cannot be built is a lab that cannot run, or a failed test, and how
packages are installed in it."""

import os
import pathlib
import subprocess
import tempfile
import unittest

from tests.support.stub_programs import StubPrograms

_PROGRAM = pathlib.Path("tests/hil/image/build").resolve()
_INSTALL = pathlib.Path("script/install-packages").resolve()
_CANNOT_RUN = 77


@unittest.skipIf(os.geteuid() != 0, "only root may make the guest")
class GuestBuild(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = pathlib.Path(folder.name)
        self.packages = self.work / "packages"
        self.packages.mkdir()
        (self.packages / "bevloc_1.0_amd64.deb").write_text("no package", encoding="ascii")
        self.guest = self.work / "guest"
        self.stubs = StubPrograms(self.work / "stubs")

    def status(self) -> int:
        command = ["bash", str(_PROGRAM), "bookworm", str(self.guest), str(self.packages)]
        return subprocess.run(
            command, env=self.stubs.environment(), capture_output=True, check=False
        ).returncode

    def test_says_that_debian_cannot_be_installed(self) -> None:
        self.stubs.put("mmdebstrap", "exit 1")
        self.assertEqual(self.status(), _CANNOT_RUN)

    def test_fails_if_a_package_cannot_be_installed(self) -> None:
        # Debian's part of the guest is there already.
        sources = b"".join(p.read_bytes() for p in sorted(_PROGRAM.parent.glob("[!.]*")))
        stamp = subprocess.run(["sha256sum"], input=sources, capture_output=True, check=True)
        (self.guest / "root/etc").mkdir(parents=True)
        (self.guest / "stamp").write_bytes(stamp.stdout.split()[0] + b"\n")
        self.stubs.put("unshare", "exit 100")  # what apt answers in the guest
        self.assertNotIn(self.status(), (0, _CANNOT_RUN))
        self.assertTrue(any(call.startswith("unshare ") for call in self.stubs.take_calls()))


@unittest.skipIf(os.geteuid() != 0, "only root may install packages")
class InstalledPackages(unittest.TestCase):
    def install(self, umask: int = 0o022, **variables: str) -> tuple[str, list[str]]:
        """Returns the command that runs in the root, and the modes of the files that apt reads."""
        with tempfile.TemporaryDirectory() as name:
            work = pathlib.Path(name)
            (work / "root/etc").mkdir(parents=True)
            package = work / "bevloc_1.0_amd64.deb"
            package.write_text("no package", encoding="ascii")
            stubs = StubPrograms(work / "stubs")
            stubs.put("unshare", f"cd {work}/root && stat -c %a etc/resolv.conf packages.*/*.deb")
            done = subprocess.run(
                ["bash", str(_INSTALL), str(work / "root"), str(package)],
                env={**stubs.environment(), **variables},
                umask=umask, capture_output=True, text=True, check=True,
            )
            return "\n".join(stubs.take_calls()), done.stdout.split()

    def test_can_be_read_by_the_user_of_apt(self) -> None:
        self.assertEqual(self.install(umask=0o077)[1], ["644", "644"])

    def test_follow_an_interrupted_installation(self) -> None:
        script = self.install()[0]
        self.assertIn("dpkg --configure -a", script)
        self.assertLess(script.index("dpkg --configure -a"), script.index("apt-get install"))

    def test_come_through_the_proxy_of_this_machine(self) -> None:
        proxy = "http_proxy=http://proxy:3128"
        self.assertIn(proxy, self.install(http_proxy="http://proxy:3128")[0])
        self.assertNotIn(proxy, self.install()[0])


if __name__ == "__main__":
    unittest.main()
