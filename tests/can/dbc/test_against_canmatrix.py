"""Decodes random frames of random signals with bevloc and with canmatrix, and compares them."""

from __future__ import annotations

import importlib.util
import json
import math
import os
import random
import subprocess
import tempfile
import unittest
from pathlib import Path

MESSAGES = 60
FRAMES = 20


def bits_of(start: int, length: int, motorola: bool) -> list[int]:
    bits = []
    for _ in range(length):
        bits.append(start)
        start = (start + 15 if start % 8 == 0 else start - 1) if motorola else start + 1
    return bits


def random_signal(source: random.Random, name: str, taken: set[int], mark: str) -> str | None:
    """A line of SG_ in free bits, which it adds to `taken`."""
    length, motorola = source.randint(1, 40), source.random() < 0.5
    kind = source.choice("++--")
    bits = bits_of(source.randrange(64), length, motorola)
    if max(bits) > 63 or taken & set(bits):
        return None
    taken.update(bits)
    scale = source.choice([1, 0.5, 0.01, -0.25, 3, 1e-5])
    offset = source.choice([0, -40, 12.5])
    order = 0 if motorola else 1
    return f' SG_ {name} {mark}: {bits[0]}|{length}@{order}{kind} ({scale},{offset}) [0|0] "x" Y'


def random_message(source: random.Random, number: int) -> list[str]:
    lines = [f"BO_ {number} M{number}: 8 X"]
    taken: set[int] = set()
    if number % 3 == 0:
        taken.update(range(4))
        lines.append(' SG_ Page M : 0|4@1+ (1,0) [0|0] "" Y')
    for index in range(40):
        mark = f"m{index % 3} " if number % 3 == 0 else ""
        line = random_signal(source, f"S{number}_{index}", taken, mark)
        if line is not None:
            lines.append(line)
    return lines


def floats() -> list[str]:
    return [
        "BO_ 1000 Floats: 8 X",
        ' SG_ F1 : 0|32@1- (1,0) [0|0] "" Y',
        ' SG_ F2 : 39|32@0- (2,0) [0|0] "" Y',
        "SIG_VALTYPE_ 1000 F1 : 1;",
        "SIG_VALTYPE_ 1000 F2 : 1;",
    ]


HAS_CANMATRIX = importlib.util.find_spec("canmatrix") is not None


@unittest.skipUnless(HAS_CANMATRIX, "python3-canmatrix is not installed")
class CanmatrixTest(unittest.TestCase):
    def test_decodes_the_same_values(self) -> None:
        import canmatrix.formats

        source = random.Random(11)
        lines = ['VERSION ""', "", "NS_ :", "", "BS_:", "", "BU_: X Y", ""]
        for number in range(1, MESSAGES + 1):
            lines += [*random_message(source, number), ""]
        lines += floats()
        ids = [*range(1, MESSAGES + 1), 1000]
        frames = [(i, source.randbytes(8)) for i in ids for _ in range(FRAMES)]
        with tempfile.TemporaryDirectory() as folder:
            dbc, log = Path(folder) / "random.dbc", Path(folder) / "random.log"
            dbc.write_text("\n".join(lines) + "\n")
            rows = [f"(1.000000) can0 {i:03X}#{data.hex().upper()}\n" for i, data in frames]
            log.write_text("".join(rows))
            done = subprocess.run([os.environ["PRINT_DECODED"], dbc, log], check=True,
                                  capture_output=True, text=True)
            matrix = canmatrix.formats.loadp_flat(str(dbc))
        decoded = [json.loads(line) for line in done.stdout.splitlines()]
        self.assertEqual(len(decoded), len(frames))
        compared = 0
        for (identifier, data), found in zip(frames, decoded):
            frame = matrix.frame_by_id(canmatrix.ArbitrationId(identifier, False))
            wanted = {name: float(signal.phys_value) for name, signal in frame.decode(data).items()}
            for name, value in found["signals"].items():
                if value is None:
                    self.assertFalse(math.isfinite(wanted[name]), name)
                    continue
                self.assertAlmostEqual(value, wanted[name], delta=1e-9 * max(1, abs(wanted[name])))
                compared += 1
            self.assertEqual(set(found["signals"]), set(wanted), f"M{identifier}")
        self.assertGreater(compared, 5 * FRAMES * MESSAGES // 2)
