"""The processes of one run, as torchrun starts them: each trains on its share of every batch.

Gradients are averaged by hand rather than by DistributedDataParallel, because the running
statistics of batch normalisation and the losses have to be averaged too, and one exchange a step
carries them all. SyncBatchNorm would make each process normalise by the whole batch, but exists on
CUDA alone and stops at every layer for it.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass

import torch
import torch.distributed as dist
from torch import Tensor


@dataclass(frozen=True)
class Share:
    """Every `count`-th sample of a stream, from number `index` on."""

    index: int = 0
    count: int = 1


WHOLE = Share()


@dataclass(frozen=True)
class Processes:
    """This process and how many there are. With one alone nothing is exchanged."""

    rank: int = 0
    count: int = 1
    device: torch.device = torch.device("cpu")

    @staticmethod
    def join() -> Processes:
        """Meets the others that torchrun has started, if any: NCCL with CUDA, else Gloo."""
        cuda = torch.cuda.is_available()
        device = torch.device("cuda", int(os.environ.get("LOCAL_RANK", 0))) if cuda else "cpu"
        count = int(os.environ.get("WORLD_SIZE", 1))
        if count == 1:
            return Processes(device=torch.device(device))
        if cuda:
            torch.cuda.set_device(device)
        dist.init_process_group("nccl" if cuda else "gloo")
        return Processes(dist.get_rank(), count, torch.device(device))

    def leave(self) -> None:
        if self.count > 1:
            dist.destroy_process_group()

    @property
    def first(self) -> bool:
        """The one that writes and prints."""
        return self.rank == 0

    @property
    def share(self) -> Share:
        return Share(self.rank, self.count)

    def average_(self, tensors: Sequence[Tensor]) -> None:
        """Each becomes its mean over the processes, the same to the last bit in all of them."""
        if self.count == 1:
            return
        flat = torch.cat([tensor.reshape(-1) for tensor in tensors])
        dist.all_reduce(flat)
        flat /= self.count
        for tensor, mean in zip(tensors, flat.split([tensor.numel() for tensor in tensors])):
            tensor.copy_(mean.view(tensor.shape))

    def from_first(self, value: float) -> float:
        """What the first process says, for what all have to decide alike."""
        if self.count == 1:
            return value
        said = torch.tensor(value, dtype=torch.float64, device=self.device)
        dist.broadcast(said, src=0)
        return said.item()
