#!/usr/bin/env python3
"""Trains on the machine to which this bundle was copied: ./train [OPTIONS of training.train]

It needs Linux on x86-64, Python 3.10 or newer, PyTorch 1.13 or newer (with CUDA, if a GPU is to
train) and NumPy. The options of the bundle (options.json) come first; those of the command line
override them. README.md beside this file says more. training/bundle.py copies this file into a
bundle as `train`.
"""

import importlib.metadata
import importlib.util
import json
import os
import platform
import re
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
LEAST_PYTHON = (3, 10)
LEAST_TORCH = (1, 13)
BUDGETS = ("--minutes", "--samples")  # a run has one of them
CONTINUES = "continues-run"  # a file of bundles that continue a run of another machine
STREAMS = 4  # samplers of a run (training/data.py), each with --sampler-threads threads


def missing() -> str:
    """What this machine lacks, in one line; empty if nothing."""
    if platform.system() != "Linux" or platform.machine() not in ("x86_64", "AMD64"):
        return f"found {platform.system()} on {platform.machine()}, wanted Linux on x86_64"
    if sys.version_info < LEAST_PYTHON:
        found, wanted = ".".join(map(str, sys.version_info[:2])), ".".join(map(str, LEAST_PYTHON))
        return f"found Python {found}, wanted {wanted} or newer; name another one: PYTHON train"
    for package, name in (("numpy", "NumPy"), ("torch", "PyTorch")):
        if importlib.util.find_spec(package) is None:
            return f"{sys.executable}: found no {name}, wanted it; install the package {package}"
    try:
        torch = importlib.metadata.version("torch")
    except importlib.metadata.PackageNotFoundError:  # this PyTorch does not state its version
        return ""
    numbers = tuple(map(int, re.findall(r"\d+", torch)[:2]))
    if numbers < LEAST_TORCH:
        return f"found PyTorch {torch}, wanted {'.'.join(map(str, LEAST_TORCH))} or newer"
    return ""


def options(given: "list[str]") -> "list[str]":
    """The options of training.train: the machine's and the bundle's own, then the given ones. Ends
    the program if the run that the bundle continues is not where it would be resumed."""
    threads = max(1, len(os.sched_getaffinity(0)) // STREAMS)
    chosen = ["--sampler-threads", str(threads), "--run", str(FOLDER / "run")]
    if (FOLDER / "photos").is_dir():
        chosen += ["--photos", str(FOLDER / "photos")]
    if (FOLDER / "start.pt").is_file():
        chosen += ["--init", str(FOLDER / "start.pt")]
    run = run_folder(given)
    if (run / "checkpoint.pt").is_file():
        chosen += ["--resume"]
    elif (FOLDER / CONTINUES).is_file():
        sys.exit(
            f"train: --run: found no checkpoint.pt in {run}, wanted that of the run that this "
            f"bundle continues; leave out --run, or copy {FOLDER / 'run'} there"
        )
    own = json.loads((FOLDER / "options.json").read_text())
    if has_budget(given):
        own = without_budget(own)
    return [*chosen, *own, *given]


def run_folder(given: "list[str]") -> Path:
    """The folder of the run: that of the last --run, or the bundle's own."""
    folder = FOLDER / "run"
    for option, following in zip(given, [*given[1:], ""]):
        if option == "--run":
            folder = Path(following)
        elif option.startswith("--run="):
            folder = Path(option[len("--run=") :])
    return folder


def has_budget(given: "list[str]") -> bool:
    return any(option.split("=")[0] in BUDGETS for option in given)


def without_budget(own: "list[str]") -> "list[str]":
    """The bundle's options without its budget, which the command line replaces."""
    kept = []
    left = iter(own)
    for option in left:
        if option in BUDGETS:
            next(left, None)
        elif option.split("=")[0] not in BUDGETS:
            kept.append(option)
    return kept


def main() -> None:
    if lack := missing():
        sys.exit(f"train: {lack}")
    environment = dict(os.environ, PYTHONPATH=str(FOLDER), PYTHONDONTWRITEBYTECODE="1")
    if "PYTHONPATH" in os.environ:
        environment["PYTHONPATH"] += os.pathsep + os.environ["PYTHONPATH"]
    command = [sys.executable, "-m", "training.train", *options(sys.argv[1:])]
    sys.stdout.flush()
    os.execve(sys.executable, command, environment)


if __name__ == "__main__":
    main()
