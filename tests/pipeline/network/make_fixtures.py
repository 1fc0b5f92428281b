#!/usr/bin/python3
"""Writes the test models of this folder, and their outputs as numpy computes them.

    make_fixtures.py                 writes fixtures/*.onnx and fixtures/*.expected
    make_fixtures.py --nano FILE     writes a model of the shipped size with random weights

fixture_models/ computes each model while building it, in float64 and independently of the C++
code. `x.expected` holds the outputs as float32, one after the other. For whole networks it holds
only every 61st value (NETWORK_STRIDE).
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER.parents[2]))

from tests.pipeline.network.fixture_models.model import Model  # noqa: E402
from tests.pipeline.network.fixture_models.networks import (  # noqa: E402
    nano_network, small_features, tiny_network, wrong_shape,
)
from tests.pipeline.network.fixture_models.operators import operator_models  # noqa: E402

FIXTURES = FOLDER / "fixtures"


def write(model: Model) -> None:
    model.save(FIXTURES / f"{model.name}.onnx")
    if model.evaluate:
        model.save_expected(FIXTURES / f"{model.name}.expected")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--nano", type=Path)
    arguments = parser.parse_args()
    if arguments.nano:
        nano_network().save(arguments.nano)
        return
    FIXTURES.mkdir(exist_ok=True)
    for quantized in (True, False):
        for model in operator_models(quantized):
            write(model)
        write(tiny_network(quantized))
    write(wrong_shape())
    write(small_features())


if __name__ == "__main__":
    main()
