"""Prints the name of the network that a run of training.train with the same options would train.

    /usr/bin/python3 -m training.exported_network --network small --view lut --minutes 60

Refuses a network that cannot be exported, so that this is known before the run and not after it.
"""

from __future__ import annotations

import sys

from tooling.errors import run_program
from training.graph import check_exportable
from training.models.config import network_config
from training.options import parse_config


def main() -> None:
    config = parse_config(sys.argv[1:], __doc__.splitlines()[0])
    network = network_config(config.network, config.view)
    check_exportable(network)
    print(network.name)


if __name__ == "__main__":
    run_program(main)
