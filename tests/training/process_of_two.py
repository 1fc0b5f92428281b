"""What test_distributed starts twice with torchrun: a short run on made-up samples.

    torchrun --nproc_per_node 2 -m tests.training.process_of_two FOLDER [POISONED_POSITION]
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import torch

from tests.training.synthetic import SyntheticStream
from training.config import TrainingConfig
from training.data import Batch
from training.distributed import Processes
from training.errors import NotFiniteError
from training.train import Trainer

EXAMPLES = 8
SAMPLES, BATCH = 12, 4


class PoisonedStream(SyntheticStream):
    """One sample has no number where its view table has weights."""

    poisoned = -1

    def next(self, count: int) -> Batch:
        batch = super().next(count)
        for i, position in enumerate(self.positions[-count:]):
            if position == self.poisoned:
                batch.weight[i] = math.nan
        return batch


def regression() -> tuple[torch.nn.Module, torch.Tensor, torch.Tensor]:
    """A model without batch normalisation, and its examples."""
    torch.manual_seed(3)
    model = torch.nn.Sequential(torch.nn.Linear(5, 4), torch.nn.Tanh(), torch.nn.Linear(4, 1))
    return model, torch.randn(EXAMPLES, 5), torch.randn(EXAMPLES, 1)


def own_gradients(processes: Processes) -> list[torch.Tensor]:
    """Of this process's examples, averaged over the processes."""
    model, inputs, targets = regression()
    own = slice(processes.rank, None, processes.count)
    torch.nn.functional.mse_loss(model(inputs[own]), targets[own]).backward()
    gradients = [parameter.grad for parameter in model.parameters()]
    processes.average_(gradients)
    return gradients


def main() -> None:
    torch.set_num_threads(1)
    folder = Path(sys.argv[1])
    PoisonedStream.poisoned = int(sys.argv[2]) if len(sys.argv) > 2 else -1
    processes = Processes.join()
    config = TrainingConfig(
        run=folder, batch=BATCH, samples=SAMPLES, warm_up_steps=1, precision="float32"
    )
    trainer = Trainer(config, lambda _, first, s: PoisonedStream(first, s), [], processes)
    try:
        trainer.run()
    except NotFiniteError as error:
        (folder / f"error{processes.rank}").write_text(str(error))
        return
    state = {
        "net": trainer.net.state_dict(),
        "average": trainer.average.state_dict(),
        "positions": trainer.stream.positions,
        "gradients": own_gradients(processes),
        "first_says": processes.from_first(10.0 + processes.rank),
    }
    torch.save(state, folder / f"rank{processes.rank}.pt")
    processes.leave()


if __name__ == "__main__":
    main()
