"""apt repositories with newer versions of the packages, signed with a key of the lab."""

import os
import pathlib
import shutil
import subprocess

# The package of which newer versions are made.
PACKAGE = "bevloc_*_amd64.deb"
_SIGNER = "lab@localhost"
_BROKEN_DAEMON = "#!/bin/sh\necho 'this daemon does not run' >&2\nexit 1\n"


class Repositories:
    """Makes repositories, and the key that signs them.

    The good version is in a folder whose name must be encoded in a URI. The daemon of the bad
    version does not run. The incomplete repository lacks a package that its index names.
    """

    GOOD = "good one"
    BAD = "bad"
    INCOMPLETE = "incomplete"
    GOOD_VERSION = "9.0.1"
    BAD_VERSION = "9.0.2"
    INCOMPLETE_VERSION = "9.0.3"

    def __init__(self, packages: pathlib.Path, folder: pathlib.Path) -> None:
        self._packages = packages
        self.folder = folder
        self.key = folder / "update-key.gpg"
        self._gnupg = folder / "gnupg"

    def make(self) -> None:
        shutil.rmtree(self.folder, ignore_errors=True)
        self._gnupg.mkdir(parents=True, mode=0o700)
        self._gpg("--passphrase", "", "--quick-gen-key", _SIGNER, "ed25519", "sign", "never")
        self.key.write_bytes(self._gpg("--export", _SIGNER))
        self._make(self.GOOD, self.GOOD_VERSION, broken=False)
        self._make(self.BAD, self.BAD_VERSION, broken=True)
        self._make(self.INCOMPLETE, self.INCOMPLETE_VERSION, broken=False)
        for package in (self.folder / self.INCOMPLETE).glob("*.deb"):
            package.unlink()

    def _make(self, name: str, version: str, broken: bool) -> None:
        repository = self.folder / name
        repository.mkdir()
        (package,) = self._packages.glob(PACKAGE)
        tree = self.folder / "tree"
        _run(["dpkg-deb", "-R", str(package), str(tree)])
        control = tree / "DEBIAN/control"
        lines = control.read_text(encoding="utf-8").splitlines()
        lines = [f"Version: {version}" if line.startswith("Version:") else line for line in lines]
        control.write_text("\n".join(lines) + "\n", encoding="utf-8")
        if broken:
            (tree / "usr/bin/bevlocd").write_text(_BROKEN_DAEMON, encoding="utf-8")
        _run(["dpkg-deb", "--root-owner-group", "-b", str(tree), str(repository)])
        shutil.rmtree(tree)
        packages = _run(["apt-ftparchive", "packages", "."], repository)
        (repository / "Packages").write_bytes(packages)
        release = _run(["apt-ftparchive", "release", "."], repository)
        (repository / "InRelease").write_bytes(self._gpg("--clearsign", given=release))

    def _gpg(self, *arguments: str, given: bytes = b"") -> bytes:
        command = ["gpg", "--homedir", str(self._gnupg), "--batch", "--quiet"]
        command += ["--pinentry-mode", "loopback", *arguments]
        return _run(command, given=given)


def _run(command: list[str], folder: pathlib.Path | None = None, given: bytes = b"") -> bytes:
    environment = {**os.environ, "LC_ALL": "C.UTF-8"}
    done = subprocess.run(
        command, cwd=folder, input=given, stdout=subprocess.PIPE, check=True, env=environment
    )
    return done.stdout
