"""The program that test_distributed starts twice: a short run on synthetic samples.

    python3 -m tests.training.process_of_two FOLDER [POISONED_POSITION]
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import torch

from tests.training.synthetic import SyntheticStream, gradient_of
from training.config import TrainingConfig
from training.data import Batch
from training.distributed import Processes, Share
from training.errors import NotFiniteError
from training.train import Trainer

EXAMPLES = 8
SAMPLES, BATCH = 12, 4


class PoisonedStream(SyntheticStream):
    """A stream in which the view weights of one sample are NaN."""

    poisoned = -1

    def next(self, count: int) -> Batch:
        batch = super().next(count)
        for i, position in enumerate(self.positions[-count:]):
            if position == self.poisoned:
                batch.weight[i] = math.nan
        return batch


def regression() -> tuple[torch.nn.Module, torch.Tensor, torch.Tensor]:
    """A model without batch normalisation, its inputs and its targets."""
    torch.manual_seed(3)
    model = torch.nn.Sequential(torch.nn.Linear(5, 4), torch.nn.Tanh(), torch.nn.Linear(4, 1))
    return model, torch.randn(EXAMPLES, 5), torch.randn(EXAMPLES, 1)


def own_gradients(processes: Processes) -> list[torch.Tensor]:
    """The gradients of this process's examples, averaged over the processes."""
    model, inputs, targets = regression()
    own = slice(processes.rank, None, processes.count)
    torch.nn.functional.mse_loss(model(inputs[own]), targets[own]).backward()
    gradients = [gradient_of(parameter) for parameter in model.parameters()]
    processes.average_(gradients)
    return gradients


def train_with(processes: Processes, folder: Path) -> None:
    """Trains, and writes this process's state or its error into `folder`."""
    config = TrainingConfig(
        run=folder, batch=BATCH, samples=SAMPLES, warm_up_steps=1, precision="float32"
    )
    streams: list[PoisonedStream] = []

    def make_stream(_: TrainingConfig, first: int, share: Share) -> PoisonedStream:
        streams.append(PoisonedStream(first, share))
        return streams[-1]

    trainer = Trainer(config, make_stream, [], processes)
    try:
        trainer.run()
    except NotFiniteError as error:
        (folder / f"error{processes.rank}").write_text(str(error))
        return
    state = {
        "net": trainer.net.state_dict(),
        "average": trainer.average.state_dict(),
        "positions": streams[-1].positions,
        "gradients": own_gradients(processes),
        "first_says": processes.from_first(10.0 + processes.rank),
    }
    torch.save(state, folder / f"rank{processes.rank}.pt")


def main() -> None:
    torch.set_num_threads(1)
    PoisonedStream.poisoned = int(sys.argv[2]) if len(sys.argv) > 2 else -1
    with Processes.join() as processes:
        train_with(processes, Path(sys.argv[1]))


if __name__ == "__main__":
    main()
