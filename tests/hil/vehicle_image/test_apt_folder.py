"""Tests that a vehicle can read the repository of an update, also if its clock is behind."""

import datetime
import email.utils
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

_PROGRAM = pathlib.Path("vehicle_image/files/usr/libexec/bevloc-image/make-apt-folder").resolve()
_PACKAGES = pathlib.Path("vehicle_image/packages.txt").resolve()
_SIGNER = "lab@localhost"
_MISSING = [tool for tool in ("apt-ftparchive", "apt-get", "gpg") if shutil.which(tool) is None]
# This vehicle had its last right time when its image was made.
_BEHIND = datetime.timedelta(days=1000)


class Packages(unittest.TestCase):
    def test_of_the_image_have_certificates_for_https(self) -> None:
        names = _PACKAGES.read_text(encoding="utf-8").splitlines()
        self.assertIn("ca-certificates", names)


@unittest.skipIf(_MISSING, f"found no {', '.join(_MISSING)} (script/packages-python.txt)")
class AptFolder(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = pathlib.Path(folder.name)
        self.signed = datetime.datetime.now(datetime.UTC) + _BEHIND
        self.make_repository()

    def make_repository(self) -> None:
        (self.work / "gnupg").mkdir(mode=0o700)
        (self.work / "repository").mkdir()
        self.gpg("--passphrase", "", "--quick-gen-key", _SIGNER, "ed25519", "sign", "never")
        (self.work / "key.gpg").write_bytes(self.gpg("--export", _SIGNER))
        (self.work / "repository/Packages").write_bytes(self.ftparchive("packages"))
        date = email.utils.format_datetime(self.signed, usegmt=True)
        release = self.ftparchive("-o", f"APT::FTPArchive::Release::Date={date}", "release")
        signed = self.gpg("--clearsign", given=release)
        (self.work / "repository/InRelease").write_bytes(signed)

    def gpg(self, *arguments: str, given: bytes = b"") -> bytes:
        command = ["gpg", "--homedir", str(self.work / "gnupg"), "--batch", "--quiet"]
        command += ["--pinentry-mode", "loopback"]
        command += ["--faked-system-time", self.signed.strftime("%Y%m%dT%H%M%S"), *arguments]
        return subprocess.run(command, input=given, capture_output=True, check=True).stdout

    def ftparchive(self, *arguments: str) -> bytes:
        command = ["apt-ftparchive", *arguments, "."]
        folder = self.work / "repository"
        return subprocess.run(command, cwd=folder, capture_output=True, check=True).stdout

    def read_repository(self, *options: str) -> subprocess.CompletedProcess[str]:
        folder = self.work / "apt"
        uri = f"file:{self.work / 'repository'}"
        program = ["bash", str(_PROGRAM), str(folder), str(self.work / "key.gpg"), uri]
        subprocess.run(program, check=True)
        # The settings of this machine may ignore the date, or clean its own folders.
        with open(folder / "apt.conf", "a", encoding="ascii") as conf:
            conf.write('Dir::Etc::Parts "/dev/null";\nDir::Etc::Main "/dev/null";\n')
        command = ["apt-get", "-q", *options, "update"]
        environment = {**os.environ, "APT_CONFIG": str(folder / "apt.conf"), "LC_ALL": "C.UTF-8"}
        return subprocess.run(
            command, env=environment, capture_output=True, text=True, check=False
        )

    def test_accepts_a_repository_of_the_future(self) -> None:
        done = self.read_repository()
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_apt_alone_refuses_it(self) -> None:
        done = self.read_repository("-o", "Acquire::Max-FutureTime=10")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("is not valid yet", done.stderr)


if __name__ == "__main__":
    unittest.main()
