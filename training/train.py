"""Trains the network on the simulator's endless stream, without repeating a sample.

    /usr/bin/python3 -m training.train --run training/runs/nano --minutes 60
    /usr/bin/python3 -m training.train --run training/runs/nano --minutes 60 --resume
    torchrun --nproc_per_node 2 -m training.train --run training/runs/nano --minutes 60

Exit status: 0 if the budget is spent or the run stopped early, 75 if --resume can continue, 70 if a
loss, gradient or weight was not finite, 1 for any other error. torchrun replaces every status but 0
by 1.
"""

from __future__ import annotations

import math
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

import torch
from torch import Tensor, nn

from tooling.errors import run_program
from training.checkpoint import load_weights, read_checkpoint, write_checkpoint
from training.compact import pack
from training.config import TrainingConfig
from training.data import Batch, Stream, augment
from training.distributed import WHOLE, Processes, Share
from training.early_stop import Patience
from training.errors import CheckpointError, NotFiniteError, TrainingError
from training.evaluate import (
    AXES,
    CLASSES,
    evaluate,
    float_inference,
    summary,
    torch_solvers,
)
from training.losses import pose_losses, semantic_loss
from training.model import real_images, real_raster
from training.models.config import network_config
from training.models.layers import channels_last, running_statistics
from training.models.network import BevNetwork
from training.optimiser import learning_rate, make_optimiser
from training.options import parse_config
from training.precision import choose_precision, cpu_flags
from training.progress import Progress
from training.read_ahead import ReadAhead
from training.rig_ranges import ranges_of_run, stored_ranges, to_store
from training.run_table import CURVES, VALIDATION, append_row, drop_rows_after
from training.solver import DEFINITION, estimate, standardise
from training.sources import training_stream, validation_set
from training.start_weights import start_with

# By default, glibc returns large blocks to the kernel at once; faulting them in again takes 20 % of
# a step. glibc reads these variables only at process start.
MALLOC_ENVIRONMENT = {
    "MALLOC_MMAP_MAX_": "0",
    "MALLOC_TRIM_THRESHOLD_": str(2**34),
    "MALLOC_TOP_PAD_": str(2**28),
}
EXIT_STOPPED = 75  # sysexits.h, EX_TEMPFAIL: the budget is not spent yet
EXIT_NOT_FINITE = 70  # sysexits.h, EX_SOFTWARE
LOSSES = (
    *("perceived", "reconstructed"),
    *("joint_x", "joint_y", "joint_yaw"),
    *("dec_x", "dec_y", "dec_yaw"),
    *("ref_x", "ref_y", "ref_yaw"),
)


MakeStream = Callable[[TrainingConfig, int, Share], Stream]


def measuring_batches(config: TrainingConfig, make_stream: MakeStream) -> list[Batch]:
    """The first samples of the run, the same in every process."""
    stream = make_stream(config, 0, WHOLE)
    batches = [stream.next(16) for _ in range(8)]
    stream.close()
    return batches


def noise_seed(config: TrainingConfig, step: int, rank: int) -> int:
    """The seed of a step's noise in one process. It differs between steps and processes in its
    lower 32 bits, because PyTorch's generator on the CPU ignores the others."""
    return (config.seed ^ (step * 0x9E3779B9) ^ (rank * 0x85EBCA6B)) & (2**63 - 1)


class Trainer:
    """One run: network, optimiser, averaged weights and progress. With several processes, each has
    its own Trainer, and all have the same weights after every step."""

    def __init__(
        self,
        config: TrainingConfig,
        make_stream: MakeStream,
        validation: list[Batch],
        processes: Processes = Processes(),
    ) -> None:
        self.config = config
        self.processes = processes
        self.device = processes.device
        self.precision = choose_precision(config.precision, self.device, cpu_flags())
        self.patience = Patience(config.patience_figure, config.patience)
        torch.manual_seed(config.seed)
        network = network_config(config.network, config.view)
        net = BevNetwork(network)
        if config.init:
            start_with(net, Path(config.init), lambda: measuring_batches(config, make_stream))
        self.rig_ranges = ranges_of_run(config) if processes.first else []
        self.net = channels_last(net.to(self.device))
        self.average = channels_last(BevNetwork(network).to(self.device))
        self.average.load_state_dict(self.net.state_dict())
        self.optimiser = make_optimiser(self.net, config)
        self.step = 0
        self.samples = 0
        self.elapsed_s = 0.0
        self.waited_s = 0.0  # time that the last step waited for its samples
        self._statistics = [
            statistic
            for module in self.net.modules()
            if isinstance(module, nn.BatchNorm2d)
            for statistic in running_statistics(module)
        ]
        config.run.mkdir(parents=True, exist_ok=True)
        if self.checkpoint_path.exists():
            self._continue()
        if processes.first:
            drop_rows_after(config.run, self.samples)
        self.validation = validation
        self._validated_step = self.step
        self._check_patience()
        self.stream = ReadAhead(make_stream(config, self.samples, processes.share), self.device)

    @property
    def checkpoint_path(self) -> Path:
        return self.config.run / "checkpoint.pt"

    def _continue(self) -> None:
        if not self.config.resume:
            wanted = "wanted --resume to continue it, or another folder for --run"
            raise TrainingError(f"{self.checkpoint_path}: found a run, {wanted}")
        self._load()

    def _check_patience(self) -> None:
        if self.config.patience == 0 or not self.processes.first:
            return
        if not self.validation:
            raise TrainingError(
                "--patience: found no validation set, wanted one; name --validation-scenes"
            )
        self.patience.check(torch_solvers(self.net.solvers), AXES, CLASSES)

    def _check_weights(self) -> None:
        for name, value in self.net.state_dict().items():
            if not torch.isfinite(value).all():
                raise NotFiniteError(f"step {self.step}: {name} is not finite; {self._last_good()}")

    def save(self) -> None:
        """Replaces the checkpoint. NotFiniteError, and no change, if a weight is not finite."""
        if not self.processes.first:
            return
        self._check_weights()
        state = {
            "model": self.net.state_dict(),
            "ema": self.average.state_dict(),
            "optimiser": self.optimiser.state_dict(),
            "step": self.step,
            "samples": self.samples,
            "elapsed_s": self.elapsed_s,
            "patience": self.patience.state(),
            "processes": self.processes.count,
            "config": self.config.as_dict() | to_store(self.rig_ranges),
        }
        write_checkpoint(pack(state) if self.config.compact else state, self.checkpoint_path)

    def _load(self) -> None:
        path, count = self.checkpoint_path, self.processes.count
        state = read_checkpoint(path, self.device)
        if (found := state.get("processes", 1)) != count:
            raise CheckpointError(
                f"{path}: found a run with {found} processes, wanted one with {count}; start "
                f"{found} processes, or a new run with --init"
            )
        load_weights(self.net, state, "model", path)
        load_weights(self.average, state, "ema", path)
        try:
            self.optimiser.load_state_dict(state["optimiser"])
            self.step, self.samples = state["step"], state["samples"]
            self.elapsed_s = state["elapsed_s"]
        except (KeyError, ValueError) as error:
            raise CheckpointError(f"{path}: the run cannot be resumed ({error})") from error
        self.rig_ranges += stored_ranges(state["config"]) or []
        if "patience" in state:
            self.patience.resume(state["patience"])

    def _last_good(self) -> str:
        if self.checkpoint_path.exists():
            return f"{self.checkpoint_path} holds the last good state"
        return "there is no checkpoint yet"

    def losses(self, batch: Batch, generator: torch.Generator, with_pose: bool) -> Tensor:
        """The losses in the order of LOSSES. Without `with_pose` (stage 1) the pose losses are
        zero."""
        images = augment(real_images(batch.images), generator)
        with torch.autocast(self.device.type, torch.bfloat16, enabled=self.precision.bfloat16):
            outputs = self.net(images, batch.index, batch.weight, real_raster(batch.raster_prior))
        bev, features_map, perceived, reconstructed = (output.float() for output in outputs)
        semantic = [
            semantic_loss(perceived, real_raster(batch.raster_truth)),
            semantic_loss(reconstructed, real_raster(batch.raster_prior)),
        ]
        finite = bool(torch.isfinite(bev).all() and torch.isfinite(features_map).all())
        if not (with_pose and finite):  # the solvers cannot process NaN
            pose_loss = torch.full((9,), 0.0 if finite else math.nan, device=self.device)
            return torch.cat((torch.stack(semantic), pose_loss))
        bev, features_map = standardise(bev), standardise(features_map)
        noise = torch.randn(len(batch), generator=generator).to(self.device)
        yaw = batch.correction[:, 2] + DEFINITION.teacher_yaw_noise_rad * noise
        solvers = self.net.solvers
        joint = solvers.joint(bev, features_map)
        decoupled = solvers.decoupled(bev, features_map, yaw)
        refined = solvers.refine(bev, features_map, estimate(decoupled))
        pose = [pose_losses(p, batch.correction).mean(0) for p in (joint, decoupled, refined)]
        return torch.cat((torch.stack(semantic), *pose))

    def train_step(self, spent: float) -> tuple[Tensor, float]:
        """Trains on one batch. Returns its losses and the norm of the gradient."""
        c = self.config
        seed = noise_seed(c, self.step, self.processes.rank)
        generator = torch.Generator().manual_seed(seed)
        torch.manual_seed(seed ^ 0xFFFFFFFF)  # of dropout
        batch = self._next_batch()
        self.net.train()
        losses = self.losses(batch, generator, with_pose=spent >= c.semantic_stage)
        joint, decoupled, refined = losses[2:].split(3)
        pose = c.joint_weight * joint.sum() + c.decoupled_weight * decoupled.sum()
        pose = pose + c.refined_weight * refined.sum()
        self.optimiser.zero_grad(set_to_none=True)
        (losses[:2].sum() + pose).backward()
        losses = losses.detach().clone()
        self.processes.average_([*self._gradients(), *self._statistics, losses])
        norm = nn.utils.clip_grad_norm_(self.net.parameters(), c.clip_norm)
        self._refuse_not_finite(losses, norm)
        for group in self.optimiser.param_groups:
            group["lr"] = group["factor"] * learning_rate(c, self.step, spent)
        self.optimiser.step()
        self._update_average()
        self.step += 1
        self.samples += c.batch
        return losses.cpu(), float(norm)

    def _gradients(self) -> list[Tensor]:
        """All gradients, zeros for missing ones, so that every process exchanges the same sizes."""
        parameters = self.net.parameters()
        return [torch.zeros_like(p) if p.grad is None else p.grad for p in parameters]

    def _next_batch(self) -> Batch:
        """This process's share of the step's samples."""
        began = time.monotonic()
        batch = self.stream.next(self.config.batch // self.processes.count)
        self.waited_s = time.monotonic() - began
        return batch

    def _refuse_not_finite(self, losses: Tensor, norm: Tensor) -> None:
        """NotFiniteError if a loss or the gradient's norm is not finite. The arguments are
        averages, so all processes stop at the same step."""
        bad = [name for name, loss in zip(LOSSES, losses.tolist()) if not math.isfinite(loss)]
        if not bad and torch.isfinite(norm):
            return
        what = f"the loss {', '.join(bad)}" if bad else "the gradient, but no loss,"
        last = self.samples + self.config.batch - 1
        raise NotFiniteError(
            f"step {self.step}: {what} is not finite on samples {self.samples} to {last} of the "
            f"stream of seed {self.config.seed}; {self._last_good()}"
        )

    @torch.no_grad()
    def _update_average(self) -> None:
        decay = min(self.config.ema_decay, (1 + self.step) / (10 + self.step))
        for mean, value in zip(self.average.state_dict().values(), self.net.state_dict().values()):
            if mean.dtype.is_floating_point:
                mean.lerp_(value, 1 - decay)
            else:
                mean.copy_(value)

    def validate(self) -> None:
        """Measures the averaged weights in the first process, whose patience is that of all.
        NotFiniteError if a weight is not finite."""
        self._validated_step = self.step
        if self.validation:
            self._check_weights()
            self._measure()
        self.patience.waited = int(self.processes.from_first(self.patience.waited))

    def _measure(self) -> None:
        solvers = torch_solvers(self.average.solvers)
        metrics = evaluate(float_inference(self.average), solvers, self.validation, self.device)
        self._append(VALIDATION, {"samples": self.samples, **metrics})
        print(summary(metrics), flush=True)
        if self.patience.limit > 0:
            self.patience.watch(metrics, self.samples)

    def _append(self, name: str, row: dict[str, float]) -> None:
        append_row(self.config.run / name, row)

    def _log(self, progress: Progress, norm: float, spent: float) -> None:
        row = dict(zip(LOSSES, (round(v, 5) for v in progress.mean_losses().tolist())))
        lr = self.optimiser.param_groups[0]["lr"]
        self._append(CURVES, {"step": self.step, "samples": self.samples, "lr": lr, **row})
        left_min = self.elapsed_s * (1 / max(spent, 1e-6) - 1) / 60
        solvers = self.net.solvers
        scales = " ".join(f"{name} {solvers.scale(name).item():.0f}" for name in solvers.log_scale)
        print(
            f"step {self.step} samples {self.samples} {progress.rate:.1f}/s "
            f"({progress.bottleneck}) left {left_min:.1f} min "
            f"lr {lr:.2e} norm {norm:.1f} | "
            + " ".join(f"{name} {value:.3f}" for name, value in row.items())
            + f" | scales {scales}",
            flush=True,
        )

    def _passed(self, minutes: float, before_s: float) -> bool:
        """Whether the run's clock has passed a multiple of `minutes` since before_s."""
        return self.elapsed_s // (60 * minutes) > before_s // (60 * minutes)

    def run(self) -> bool:
        """Trains until the run is finished (True) or this process has to stop before (False). The
        first process's clock decides for all."""
        c = self.config
        started_s, offset_s = self.elapsed_s, self.elapsed_s - time.monotonic()
        progress = Progress()
        while not self.finished:
            spent = c.budget_spent(self.elapsed_s, self.samples)
            began, before_s = time.monotonic(), self.elapsed_s
            losses, norm = self.train_step(spent)
            now = time.monotonic()
            progress.add(losses, c.batch, now - began, self.waited_s)
            self.elapsed_s = self.processes.from_first(now + offset_s)
            if self.step % c.log_steps == 0:
                if self.processes.first:
                    self._log(progress, norm, spent)
                progress = Progress()
            if self._passed(c.validation_minutes, before_s):
                self.validate()
            if self._passed(c.checkpoint_minutes, before_s):
                self.save()
            if 0 < 60 * c.stop_after_minutes < self.elapsed_s - started_s:
                break
        if self._validated_step != self.step:
            self.validate()
        self.save()
        self.stream.close()
        return self.finished

    @property
    def finished(self) -> bool:
        """Whether the budget is spent or the run has stopped improving."""
        spent = self.config.budget_spent(self.elapsed_s, self.samples)
        return spent >= 1.0 or self.patience.exhausted


def train(config: TrainingConfig, processes: Processes) -> bool:
    """Executes the run; returns whether it is finished."""
    validation = validation_set(config) if processes.first else []
    trainer = Trainer(config, training_stream, validation, processes)
    if processes.first:
        print(f"precision: {trainer.precision}", flush=True)
    finished = trainer.run()
    if trainer.patience.exhausted:
        ending = f"stopped early: {trainer.patience}"
    else:
        ending = "finished" if finished else "stopped; continue with --resume"
    if processes.first:
        print(ending, flush=True)
    return finished


def main() -> None:
    processes = int(os.environ.get("WORLD_SIZE", 1))  # set by torchrun
    config = parse_config(sys.argv[1:], __doc__.splitlines()[0], processes)
    if any(os.environ.get(key) != value for key, value in MALLOC_ENVIRONMENT.items()):
        environment = os.environ | MALLOC_ENVIRONMENT | {"OMP_NUM_THREADS": str(config.threads)}
        command = [sys.executable, "-m", "training.train", *sys.argv[1:]]
        os.execve(sys.executable, command, environment)
    torch.set_num_threads(config.threads)
    try:
        with Processes.join() as joined:
            finished = train(config, joined)
    except NotFiniteError as error:
        print(error, file=sys.stderr, flush=True)
        sys.exit(EXIT_NOT_FINITE)
    sys.exit(0 if finished else EXIT_STOPPED)


if __name__ == "__main__":
    run_program(main)
