"""The program behind script/hil: boots the guest once and plays scenarios in it. With --check, it
only checks the options, before script/hil builds what the scenarios need."""

import argparse
import functools
import pathlib
import signal
import sys

from tests.hil.lab.agent import LabError
from tests.hil.lab.bench import Bench, Folders, Run
from tests.hil.lab.outcome import Outcome
from tests.hil.lab.program import play, report, run
from tests.hil.lab.scenarios import SCENARIOS


def main() -> int:
    arguments = _arguments()
    if arguments.check:
        return 0
    # An interrupted run must stop its processes too.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    folders = Folders(*(getattr(arguments, f).resolve() for f in Folders.__dataclass_fields__))
    folders.results.mkdir(parents=True, exist_ok=True)
    outcomes: dict[str, Outcome] = {}
    with Bench(folders, arguments.driver) as bench:
        print("lab: the guest is up", flush=True)
        for name in arguments.names:
            outcomes[name] = play(name, functools.partial(_play, bench, name))
        if arguments.keep:
            _talk(bench)
    return report(outcomes, folders.results)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="script/hil", description=__doc__)
    parser.add_argument("--check", action="store_true", help=argparse.SUPPRESS)
    runs = "--check" not in sys.argv
    for folder in Folders.__dataclass_fields__:
        parser.add_argument(f"--{folder}", type=pathlib.Path, required=runs, help=argparse.SUPPRESS)
    parser.add_argument(
        "--driver",
        choices=("v4l2", "libcamera", "none"),
        default="v4l2",
        help="the daemon's driver for the emulated cameras; none: no cameras",
    )
    parser.add_argument(
        "--keep", action="store_true", help="keep the guest and read commands (docs/lab.md)"
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(SCENARIOS)}")
    arguments = parser.parse_args()
    if not arguments.names and not arguments.keep:
        parser.error(f"found no scenario, wanted one or more of {', '.join(SCENARIOS)}")
    for name in arguments.names:
        if name not in SCENARIOS:
            parser.error(f"found no scenario '{name}', wanted one of {', '.join(SCENARIOS)}")
        if SCENARIOS[name].needs_usb and arguments.driver == "none":
            parser.error(f"'{name}' needs cameras, found --driver none")
    return arguments


def _play(bench: Bench, name: str) -> Outcome:
    with Run(bench, name) as scenario:
        return SCENARIOS[name].play(scenario)


def _talk(bench: Bench) -> None:
    """Runs lines from the terminal: a script for the guest, or `@` and a camera command."""
    for line in sys.stdin:
        try:
            if line.startswith("@"):
                print(bench.cameras.command(line[1:].strip()), flush=True)
            else:
                print(bench.agent.run(line, timeout_s=600).output, end="", flush=True)
        except LabError as error:
            print(error, flush=True)


if __name__ == "__main__":
    run(main)
