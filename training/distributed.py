"""Data-parallel training: torchrun starts several processes, each trains on a share of every batch.

Gradients are averaged here and not by DistributedDataParallel, because the running statistics of
batch normalisation and the losses must be averaged too: one all-reduce per step carries all of
them. SyncBatchNorm would normalise by the whole batch, but it needs CUDA and synchronises at every
layer.
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
    """Every `count`-th sample of a stream, starting at sample `index`."""

    index: int = 0
    count: int = 1


WHOLE = Share()


@dataclass(frozen=True)
class Processes:
    """This process (`rank`) of `count` processes. With one process, nothing is communicated.

    This context manager leaves the group at its end, also after an error. Otherwise the C++ library
    can abort the interpreter, because Gloo's threads still run when it ends.
    """

    rank: int = 0
    count: int = 1
    device: torch.device = torch.device("cpu")

    @staticmethod
    def join() -> Processes:
        """Joins the process group that torchrun has started, if any: NCCL with CUDA, else Gloo."""
        cuda = torch.cuda.is_available()
        device = torch.device("cpu")
        if cuda:
            device = torch.device("cuda", int(os.environ.get("LOCAL_RANK", 0)))
        count = int(os.environ.get("WORLD_SIZE", 1))
        if count == 1:
            return Processes(device=device)
        if cuda:
            torch.cuda.set_device(device)
        dist.init_process_group("nccl" if cuda else "gloo")
        return Processes(dist.get_rank(), count, device)

    def __enter__(self) -> Processes:
        return self

    def __exit__(self, *_: object) -> None:
        if self.count > 1:
            dist.destroy_process_group()

    @property
    def first(self) -> bool:
        """Whether this is the process that writes files and prints."""
        return self.rank == 0

    @property
    def share(self) -> Share:
        return Share(self.rank, self.count)

    def average_(self, tensors: Sequence[Tensor]) -> None:
        """Replaces each tensor by its mean over the processes, bit-identical in all of them."""
        if self.count == 1:
            return
        flat = torch.cat([tensor.reshape(-1) for tensor in tensors])
        dist.all_reduce(flat)
        flat /= self.count
        for tensor, mean in zip(tensors, flat.split([tensor.numel() for tensor in tensors])):
            tensor.copy_(mean.view(tensor.shape))

    def from_first(self, value: float) -> float:
        """The first process's `value`, so that all processes take the same decision."""
        if self.count == 1:
            return value
        shared = torch.tensor(value, dtype=torch.float64, device=self.device)
        dist.broadcast(shared, src=0)
        return shared.item()
