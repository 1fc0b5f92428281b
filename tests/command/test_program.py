"""Tries the program bevloc as its user does: help, exit codes, completion, manual pages."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BIN = Path(os.environ["BEVLOC_BIN"])
PROGRAM = BIN / ("bevloc" if (BIN / "bevloc").exists() else "bevloc_vehicle")


def run(*words: str, **options: str) -> subprocess.CompletedProcess[str]:
    command = [str(PROGRAM), *words]
    return subprocess.run(command, capture_output=True, text=True, cwd=options.get("cwd", ROOT))


def state_of(pid: int) -> str:
    """The state of a process as in proc(5), such as R for running and S for waiting."""
    return Path(f"/proc/{pid}/stat").read_text().rpartition(") ")[2][0]


def leaves(*path: str) -> list[tuple[str, ...]]:
    """All commands that have no commands below them."""
    text = run(*path, "--help").stdout
    below = text.partition("\nSubcommands:\n")[2]
    names = re.findall(r"^  (\S+)", below.partition("\n\n")[0], re.MULTILINE)
    if "Examples:" in text:
        return [path]
    return [leaf for name in names for leaf in leaves(*path, name)] if names else [path]


class ProgramTest(unittest.TestCase):
    def test_every_command_has_examples_with_options_that_it_has(self) -> None:
        commands = leaves()
        self.assertGreaterEqual(len(commands), 5)
        for command in commands:
            text = run(*command, "--help").stdout
            examples = re.findall(r"bevloc [^>)&\n]+", text.partition("Examples:\n")[2])
            self.assertTrue(examples, command)
            for example in examples:
                self.assertTrue(example.startswith("bevloc " + " ".join(command)), example)
                for option in re.findall(r"--[a-z-]+", example):
                    self.assertIn(option, text.partition("Examples:\n")[0], example)

    def test_exit_codes(self) -> None:
        self.assertEqual(run("--version").returncode, 0)
        self.assertEqual(run("schema", "--help").returncode, 0)
        self.assertEqual(run().returncode, 2)
        self.assertEqual(run("no-such-command").returncode, 2)
        self.assertEqual(run("doctor", "--config", "no_such_file").returncode, 2)
        with tempfile.TemporaryDirectory() as folder:
            taken = Path(folder) / "mine.yaml"
            taken.write_text("mine")
            refused = run("init", "--yes", "--out", str(taken))
            self.assertEqual(refused.returncode, 2)
            # Libraries may write lines of their own, as libcamera 0.4 does without a DMA heap.
            own = [line for line in refused.stderr.splitlines() if line.startswith("bevloc")]
            self.assertEqual(len(own), 1)
            self.assertEqual(taken.read_text(), "mine")

    def test_output_that_does_not_arrive_is_an_error(self) -> None:
        for words in (["schema"], ["completion", "bash"]):
            with open("/dev/full", "w") as full:
                ended = subprocess.run(
                    [PROGRAM, *words], stdout=full, stderr=subprocess.PIPE, text=True, check=False
                )
            self.assertEqual(ended.returncode, 2, words)
            self.assertIn("bevloc: ", ended.stderr)
            self.assertIn("No space left on device", ended.stderr)

    def test_a_message_shows_the_bytes_of_a_damaged_file(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            log = Path(folder) / "can.log"
            log.write_bytes(b"(1.0) can0 \0\x1b[2J#00\n")
            ended = run("listen", str(log))
        self.assertEqual(ended.returncode, 2)
        self.assertIn(r"found '(1.0) can0 \x00\x1B[2J#00', wanted", ended.stderr)
        self.assertEqual(re.findall(r"[\x00-\x09\x0b-\x1f]", ended.stderr), [])

    def test_an_interrupt_ends_listening_while_no_line_comes(self) -> None:
        command = [str(PROGRAM), "listen", "-"]
        pipe = subprocess.PIPE
        with subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True) as listening:
            assert listening.stdin and listening.stdout
            listening.stdin.write("(5.000000) can0 500#AD4481FF00007AD0\n")
            listening.stdin.flush()
            self.assertIn("State=ACQUIRING", listening.stdout.readline())
            while state_of(listening.pid) != "S":  # it waits for the next line
                pass
            listening.send_signal(signal.SIGINT)
            totals = listening.stdout.read()
            self.assertEqual(listening.wait(), 0)
        self.assertIn("frames of other messages", totals)

    def test_doctor_prints_json(self) -> None:
        answer = run("doctor", "--json")
        report = json.loads(answer.stdout)
        levels = ["ok", "warning", "problem"]
        worst = max(levels.index(finding["level"]) for finding in report["findings"])
        self.assertEqual(answer.returncode, worst)
        self.assertEqual(report["worst"], levels[worst])
        for finding in report["findings"]:
            self.assertEqual("fix" in finding, finding["level"] != "ok")

    def test_bash_completes_in_a_shell(self) -> None:
        line = (
            "source completion; COMP_WORDS=(bevloc doc); COMP_CWORD=1; _bevloc_complete;"
            "echo ${COMPREPLY[*]}; COMP_WORDS=(bevlocd --conf); COMP_CWORD=1; _bevlocd_complete;"
            "echo ${COMPREPLY[*]}; complete -p bevloc bevlocd"
        )
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "completion").write_text(run("completion", "bash").stdout)
            command = ["bash", "--norc", "-uc", line]
            shell = subprocess.run(command, capture_output=True, text=True, cwd=folder)
        self.assertEqual(shell.stderr, "")
        self.assertEqual(shell.stdout.splitlines()[:2], ["doctor", "--config"])

    def test_the_installed_completion_asks_the_program(self) -> None:
        line = "source command/manual/installed/bevloc; complete -p bevloc bevlocd"
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "bevloc").symlink_to(PROGRAM)
            environment = {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}"}
            command = ["bash", "--norc", "-uc", line]
            shell = subprocess.run(
                command, capture_output=True, text=True, cwd=ROOT, env=environment
            )
        self.assertEqual(shell.stderr, "")
        completed = ["complete -F _bevloc_complete bevloc", "complete -F _bevlocd_complete bevlocd"]
        self.assertEqual(shell.stdout.splitlines(), completed)

    def test_zsh_accepts_the_completion(self) -> None:
        if shutil.which("zsh") is None:
            self.skipTest("zsh is not installed")
        script = run("completion", "zsh").stdout
        shell = subprocess.run(["zsh", "-n"], input=script, capture_output=True, text=True)
        self.assertEqual((shell.returncode, shell.stderr), (0, ""))

    def test_manual_pages_are_roff_without_a_warning(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(run("manual", "--out", folder).returncode, 0)
            pages = sorted(page.name for page in Path(folder).iterdir())
            self.assertEqual(pages, ["bevloc.1", "bevloc.yaml.5", "bevlocd.8"])
            daemon = (Path(folder) / "bevlocd.8").read_text()
            for line in (
                "0  it was told to end, or the simulated drive is over",
                r"0  with \-\-check\-config: it found no mistake",
                "3  it was told to end, or the ignition went off, and a thread hung",
            ):
                self.assertIn(line, daemon)
            for page in pages:
                command = ["groff", "-man", "-ww", "-Wbreak", "-Tutf8", page]
                groff = subprocess.run(command, capture_output=True, text=True, cwd=folder)
                self.assertEqual((groff.returncode, groff.stderr), (0, ""), page)
                self.assertGreater(len(groff.stdout), 500)


if __name__ == "__main__":
    unittest.main()
