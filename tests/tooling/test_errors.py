"""Tests how programs end on errors, and the call of programs that script/build makes."""

from __future__ import annotations

import tempfile
import unittest
from pathlib import Path

from tooling.built_program import run_built
from tooling.errors import UserError, run_program


class RunProgram(unittest.TestCase):
    def ending(self, error: Exception) -> object:
        def main() -> None:
            raise error

        with self.assertRaises(SystemExit) as ended:
            run_program(main)
        return ended.exception.code

    def test_an_error_of_the_user_is_one_line(self) -> None:
        self.assertEqual(self.ending(UserError("a.yaml: wanted b")), "a.yaml: wanted b")

    def test_a_file_that_the_system_refuses_is_named(self) -> None:
        said = self.ending(FileNotFoundError(2, "No such file or directory", "/nowhere"))
        self.assertEqual(
            said, "/nowhere: found no way to use it (No such file or directory), wanted a usable "
            "file or folder"
        )

    def test_a_system_error_without_a_file_keeps_its_traceback(self) -> None:
        def main() -> None:
            raise BrokenPipeError()

        with self.assertRaises(BrokenPipeError):
            run_program(main)


class RunBuilt(unittest.TestCase):
    def test_returns_what_the_program_prints(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            done = run_built(["/bin/pwd"], folder=Path(name))
            self.assertEqual((done.returncode, done.stdout), (0, f"{Path(name).resolve()}\n"))

    def test_names_a_program_that_is_missing(self) -> None:
        with self.assertRaisesRegex(UserError, "^/no/bevloc: found no program that runs"):
            run_built([Path("/no/bevloc")])


if __name__ == "__main__":
    unittest.main()
