"""Tests script/clang-tidy, with programs that stand for clang-tidy."""

from __future__ import annotations

import contextlib
import io
import pathlib
import tempfile
import unittest
from types import ModuleType
from unittest import mock

from tests.support.script_module import load_script
from tests.support.stub_programs import StubPrograms


class CheckTest(unittest.TestCase):
    script: ModuleType

    @classmethod
    def setUpClass(cls) -> None:
        cls.script = load_script("clang-tidy")

    def check(self, program: str, parts: int = 0) -> tuple[bool, str]:
        """What is said about a unit by a clang-tidy that does this, and whether it is clean."""
        printed = io.StringIO()
        with tempfile.TemporaryDirectory() as name:
            stubs = StubPrograms(pathlib.Path(name) / "stubs")
            stubs.put("clang-tidy", program)
            units = tuple(
                self.script.Unit(pathlib.Path(f"part_{i}.cpp"), ()) for i in range(parts)
            )
            with (
                mock.patch.dict("os.environ", stubs.environment()),
                mock.patch.object(self.script, "BUILD", pathlib.Path(name)),
                contextlib.redirect_stdout(printed),
            ):
                clean = self.script.check(self.script.Unit(pathlib.Path("a.cpp"), (), units))
        return clean, printed.getvalue()

    def test_accepts_a_source_without_findings(self) -> None:
        self.assertEqual(self.check("echo '1 warning generated.' >&2"), (True, ""))

    def test_prints_findings(self) -> None:
        clean, said = self.check("echo 'a.cpp:1: error'; exit 1")
        self.assertFalse(clean)
        self.assertIn("a.cpp:1: error", said)

    def test_does_not_accept_what_a_killed_program_has_not_read(self) -> None:
        clean, said = self.check("echo 'out of memory' >&2; kill -9 $$")
        self.assertFalse(clean)
        self.assertIn("clang-tidy ended with -9: out of memory", said)

    def test_reads_the_parts_alone_when_the_program_is_killed_at_the_whole(self) -> None:
        killed_at_the_whole = 'case "$*" in *a.cpp*) kill -9 $$ ;; esac'
        clean, said = self.check(killed_at_the_whole, parts=2)
        self.assertTrue(clean)
        self.assertIn("a.cpp is read in parts", said)


if __name__ == "__main__":
    unittest.main()
