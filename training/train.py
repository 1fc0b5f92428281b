"""Trains the network on the simulator's endless stream; no sample is ever seen twice.

    /usr/bin/python3 -m training.train --run training/runs/nano --minutes 60 --bf16
    /usr/bin/python3 -m training.train --run training/runs/nano --minutes 60 --bf16 --resume
"""

from __future__ import annotations

import argparse
import csv
import dataclasses
import math
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

import torch
from torch import Tensor, nn

from training.config import TrainingConfig
from training.data import Batch, Stream, augment
from training.evaluate import (
    evaluate,
    float_inference,
    summary,
    torch_solvers,
)
from training.losses import pose_losses, semantic_loss
from training.model import Nano, real_images, real_raster
from training.nuscenes.errors import NuscenesError
from training.solver import DEFINITION, standardise
from training.sources import training_stream, validation_set

# glibc gives large blocks back to the kernel at once, and faulting them in again costs a fifth of a
# step. It reads these at start only.
MALLOC_ENVIRONMENT = {
    "MALLOC_MMAP_MAX_": "0",
    "MALLOC_TRIM_THRESHOLD_": str(2**34),
    "MALLOC_TOP_PAD_": str(2**28),
}
EXIT_STOPPED = 75  # sysexits.h, EX_TEMPFAIL: the budget is not spent yet
LOSSES = (
    *("perceived", "reconstructed"),
    *("joint_x", "joint_y", "joint_yaw"),
    *("dec_x", "dec_y", "dec_yaw"),
)


class Trainer:
    """One run: network, optimiser, averaged weights and how far it has come."""

    def __init__(
        self,
        config: TrainingConfig,
        make_stream: Callable[[TrainingConfig, int], Stream],
        validation: list[Batch],
    ) -> None:
        self.config = config
        self.device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
        torch.manual_seed(config.seed)
        self.net = Nano().to(self.device, memory_format=torch.channels_last)
        if config.init:
            self.net.load_state_dict(torch.load(config.init, map_location=self.device)["ema"])
        self.average = Nano().to(self.device, memory_format=torch.channels_last)
        self.average.load_state_dict(self.net.state_dict())
        self.optimiser = torch.optim.AdamW(
            self._parameter_groups(), lr=config.learning_rate, betas=(0.9, 0.98)
        )
        self.step = 0
        self.samples = 0
        self.elapsed_s = 0.0
        config.run.mkdir(parents=True, exist_ok=True)
        if config.resume and self.checkpoint_path.exists():
            self._load()
        self.stream = make_stream(config, self.samples)
        self.validation = validation

    @property
    def checkpoint_path(self) -> Path:
        return self.config.run / "checkpoint.pt"

    def _parameter_groups(self) -> list[dict]:
        scales = list(self.net.solvers.parameters())
        rest = [p for p in self.net.parameters() if not any(p is scale for scale in scales)]
        decay = self.config.weight_decay
        return [
            {"params": [p for p in rest if p.ndim > 1], "weight_decay": decay, "factor": 1.0},
            {"params": [p for p in rest if p.ndim <= 1], "weight_decay": 0.0, "factor": 1.0},
            {"params": scales, "weight_decay": 0.0, "factor": self.config.scale_rate_factor},
        ]

    def save(self) -> None:
        partial = self.checkpoint_path.with_suffix(".partial")
        torch.save(
            {
                "model": self.net.state_dict(),
                "ema": self.average.state_dict(),
                "optimiser": self.optimiser.state_dict(),
                "step": self.step,
                "samples": self.samples,
                "elapsed_s": self.elapsed_s,
                "config": self.config.as_dict(),
            },
            partial,
        )
        partial.replace(self.checkpoint_path)

    def _load(self) -> None:
        state = torch.load(self.checkpoint_path, map_location=self.device)
        self.net.load_state_dict(state["model"])
        self.average.load_state_dict(state["ema"])
        self.optimiser.load_state_dict(state["optimiser"])
        self.step, self.samples = state["step"], state["samples"]
        self.elapsed_s = state["elapsed_s"]

    def _learning_rate(self, spent: float) -> float:
        c = self.config
        warm = min(1.0, (self.step + 1) / c.warm_up_steps)
        annealed = max(0.0, (spent - c.anneal_from) / (1.0 - c.anneal_from))
        cosine = c.final_rate + (1 - c.final_rate) * 0.5 * (1 + math.cos(math.pi * annealed))
        return c.learning_rate * warm * cosine

    def losses(self, batch: Batch, generator: torch.Generator, with_pose: bool) -> Tensor:
        """The eight losses in the order of LOSSES; the pose losses are zero in stage 1."""
        images = augment(real_images(batch.images), generator)
        with torch.autocast(self.device.type, torch.bfloat16, enabled=self.config.bf16):
            outputs = self.net(images, batch.index, batch.weight, real_raster(batch.raster_prior))
        bev, features_map, perceived, reconstructed = (output.float() for output in outputs)
        semantic = [
            semantic_loss(perceived, real_raster(batch.raster_truth)),
            semantic_loss(reconstructed, real_raster(batch.raster_prior)),
        ]
        if not with_pose:
            return torch.cat((torch.stack(semantic), torch.zeros(6, device=self.device)))
        bev, features_map = standardise(bev), standardise(features_map)
        noise = torch.randn(len(batch), generator=generator).to(self.device)
        yaw = batch.correction[:, 2] + DEFINITION.teacher_yaw_noise_rad * noise
        joint = pose_losses(self.net.solvers.joint(bev, features_map), batch.correction)
        decoupled = pose_losses(
            self.net.solvers.decoupled(bev, features_map, yaw), batch.correction
        )
        return torch.cat((torch.stack(semantic), joint.mean(0), decoupled.mean(0)))

    def train_step(self, spent: float) -> tuple[Tensor, float]:
        """One batch; its losses and the norm of its gradient."""
        c = self.config
        generator = torch.Generator().manual_seed((c.seed ^ (self.step * 0x9E3779B9)) & (2**63 - 1))
        batch = self.stream.next(c.batch).to(self.device)
        self.net.train()
        losses = self.losses(batch, generator, with_pose=spent >= c.semantic_stage)
        pose = c.joint_weight * losses[2:5].sum() + c.decoupled_weight * losses[5:8].sum()
        self.optimiser.zero_grad(set_to_none=True)
        (losses[:2].sum() + pose).backward()
        norm = nn.utils.clip_grad_norm_(self.net.parameters(), c.clip_norm)
        for group in self.optimiser.param_groups:
            group["lr"] = group["factor"] * self._learning_rate(spent)
        if torch.isfinite(norm):
            self.optimiser.step()
        self._update_average()
        self.step += 1
        self.samples += c.batch
        return losses.detach().cpu(), float(norm)

    @torch.no_grad()
    def _update_average(self) -> None:
        decay = min(self.config.ema_decay, (1 + self.step) / (10 + self.step))
        for mean, value in zip(self.average.state_dict().values(), self.net.state_dict().values()):
            if mean.dtype.is_floating_point:
                mean.lerp_(value, 1 - decay)
            else:
                mean.copy_(value)

    def validate(self) -> None:
        if not self.validation:
            return
        solvers = torch_solvers(self.average.solvers)
        metrics = evaluate(float_inference(self.average), solvers, self.validation, self.device)
        self._append("validation.csv", {"samples": self.samples, **metrics})
        print(summary(metrics), flush=True)

    def _append(self, name: str, row: dict[str, float]) -> None:
        path = self.config.run / name
        new = not path.exists()
        with path.open("a", newline="") as file:
            writer = csv.DictWriter(file, list(row))
            if new:
                writer.writeheader()
            writer.writerow(row)

    def _log(self, losses: Tensor, norm: float, spent: float, rate: float) -> None:
        row = dict(zip(LOSSES, (round(v, 5) for v in losses.tolist())))
        lr = self.optimiser.param_groups[0]["lr"]
        self._append("curves.csv", {"step": self.step, "samples": self.samples, "lr": lr, **row})
        left_min = self.elapsed_s * (1 / max(spent, 1e-6) - 1) / 60
        solvers = self.net.solvers
        scales = " ".join(f"{name} {solvers.scale(name).item():.0f}" for name in solvers.log_scale)
        print(
            f"step {self.step} samples {self.samples} {rate:.1f}/s left {left_min:.1f} min "
            f"lr {lr:.2e} norm {norm:.1f} | "
            + " ".join(f"{name} {value:.3f}" for name, value in row.items())
            + f" | scales {scales}",
            flush=True,
        )

    def run(self) -> bool:
        """Trains until the budget is spent (True) or this process has to stop (False)."""
        c = self.config
        began = time.monotonic()
        before_s, last_save = self.elapsed_s, began
        last_validation, last_log = began, began
        total, count, norm = torch.zeros(len(LOSSES)), 0, 0.0
        while (spent := c.budget_spent(self.elapsed_s, self.samples)) < 1.0:
            losses, norm = self.train_step(spent)
            total, count = total + losses, count + 1
            now = time.monotonic()
            self.elapsed_s = before_s + now - began
            if self.step % c.log_steps == 0:
                self._log(total / count, norm, spent, count * c.batch / (now - last_log))
                total, count, last_log = torch.zeros(len(LOSSES)), 0, now
            if now - last_save > 60 * c.checkpoint_minutes:
                self.save()
                last_save = now
            if now - last_validation > 60 * c.validation_minutes:
                self.validate()
                last_validation = last_log = time.monotonic()
            if c.stop_after_minutes > 0 and now - began > 60 * c.stop_after_minutes:
                break
        self.save()
        self.stream.close()
        return c.budget_spent(self.elapsed_s, self.samples) >= 1.0


def parse_config(arguments: list[str]) -> TrainingConfig:
    """Every field of TrainingConfig is an option."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for field in dataclasses.fields(TrainingConfig):
        option = "--" + field.name.replace("_", "-")
        if isinstance(field.default, bool):
            parser.add_argument(option, action="store_true")
        else:
            parser.add_argument(option, type=type(field.default), default=field.default)
    config = TrainingConfig(**vars(parser.parse_args(arguments)))
    if (config.minutes > 0) == (config.samples > 0):
        parser.error("give the budget: either --minutes or --samples")
    return config


def main() -> None:
    config = parse_config(sys.argv[1:])
    if any(os.environ.get(key) != value for key, value in MALLOC_ENVIRONMENT.items()):
        environment = os.environ | MALLOC_ENVIRONMENT | {"OMP_NUM_THREADS": str(config.threads)}
        command = [sys.executable, "-m", "training.train", *sys.argv[1:]]
        os.execve(sys.executable, command, environment)
    torch.set_num_threads(config.threads)
    try:
        trainer = Trainer(config, training_stream, validation_set(config))
        finished = trainer.run()
    except NuscenesError as error:
        sys.exit(f"nuScenes: {error}")
    trainer.validate()
    print("finished" if finished else "stopped; go on with --resume", flush=True)
    sys.exit(0 if finished else EXIT_STOPPED)


if __name__ == "__main__":
    main()
