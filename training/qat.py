"""Quantization-aware training: fine-tunes a trained network while simulating its int8 arithmetic.

    /usr/bin/python3 -m training.qat training/runs/nano/checkpoint.pt --run training/runs/qat \\
        --samples 2000

Writes checkpoint.pt into the run's folder. It contains the quantization, so training.export_onnx
exports exactly the trained model. Results are in docs/quantization.md.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import torch
from torch import Tensor, nn

from tooling.errors import run_program
from tooling.option_types import above_zero, positive
from training.checkpoint import (
    load_network,
    new_checkpoint,
    nuisances_of,
    read_checkpoint,
    state_of_weights,
    write_checkpoint,
)
from training.config import FIRST_TRAINING_SEED, QAT_SEEDS
from training.data import Batch, SamplerStream, Stream
from training.errors import NotFiniteError
from training.export_onnx import calibration_batches, check_simulated
from training.fake_quantization import FakeQuantized
from training.losses import pose_losses, semantic_loss
from training.model import real_raster
from training.quantize import quantize
from training.solver import PoseSolvers, standardise

SEED = FIRST_TRAINING_SEED + QAT_SEEDS  # scenes that neither a run nor the calibration reaches
POSE_WEIGHT = 0.1  # as in training.train
DROP_CAMERA_PROBABILITY = 0.15
CLIP_NORM = 5.0
LOG_STEPS = 10


def fine_tuning_loss(
    outputs: tuple[Tensor, Tensor, Tensor], solvers: PoseSolvers, batch: Batch
) -> Tensor:
    """The losses of training's second stage on the outputs of the simulated int8 model: of the
    perceived mask and of the poses of the joint and the decoupled solver. The losses of the
    reconstructed mask, which the int8 model does not have, and of the refined poses are left
    out."""
    bev, features_map, perceived = outputs
    sides = standardise(bev), standardise(features_map)
    posteriors = solvers.joint(*sides), solvers.decoupled(*sides, None)
    pose = torch.stack([pose_losses(p, batch.correction).mean(0).sum() for p in posteriors]).sum()
    return semantic_loss(perceived, real_raster(batch.raster_truth)) + POSE_WEIGHT * pose


def fine_tune(
    network: FakeQuantized, stream: Stream, steps: int, batch_size: int, rate: float
) -> list[float]:
    """Trains and returns the loss of every step. The learning rate falls to zero along a half
    cosine. The solvers' scales are not trained."""
    optimiser = torch.optim.Adam(network.parameters(), lr=rate)
    schedule = torch.optim.lr_scheduler.LambdaLR(
        optimiser, lambda step: 0.5 * (1 + math.cos(math.pi * step / steps))
    )
    losses: list[float] = []
    for step in range(steps):
        batch = stream.next(batch_size)
        loss = fine_tuning_loss(network(batch), network.net.solvers, batch)
        optimiser.zero_grad(set_to_none=True)
        loss.backward()
        norm = nn.utils.clip_grad_norm_(network.parameters(), CLIP_NORM)
        if not (torch.isfinite(loss) and torch.isfinite(norm)):
            raise NotFiniteError(
                f"step {step}: found loss {loss.item()} and gradient norm {norm}, "
                "wanted finite values; lower the learning rate"
            )
        optimiser.step()
        schedule.step()
        losses.append(loss.item())
        if len(losses) % LOG_STEPS == 0:
            mean = sum(losses[-LOG_STEPS:]) / LOG_STEPS
            print(f"step {step + 1} of {steps}: loss {mean:.4f}", flush=True)
    return losses


def save(network: FakeQuantized, first: Path, samples: int, path: Path) -> None:
    """Writes a checkpoint in the format of training.train; `first` is the initial checkpoint."""
    quantization, state = network.finish(), read_checkpoint(first)
    weights = network.net.state_dict()
    finished = state_of_weights(weights, state["config"], state["samples"] + samples)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_checkpoint({**finished, "quantization": quantization.state()}, path)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("checkpoint", type=Path)
    parser.add_argument("--run", type=Path, required=True, help="folder for checkpoint.pt")
    parser.add_argument("--samples", type=positive, default=2000, help="number of training samples")
    parser.add_argument("--batch", type=positive, default=8)
    parser.add_argument("--learning-rate", type=above_zero, default=3e-5)
    parser.add_argument(
        "--calibration", type=positive, default=384, help="number of calibration samples"
    )
    parser.add_argument("--threads", type=positive, default=1)
    arguments = parser.parse_args()
    steps = arguments.samples // arguments.batch
    if steps == 0:
        wanted = f"wanted at least one batch of {arguments.batch}"
        parser.error(f"--samples: found {arguments.samples}, {wanted}")
    torch.set_num_threads(arguments.threads)
    check_simulated(read_checkpoint(arguments.checkpoint)["config"], arguments.checkpoint)
    out = new_checkpoint(arguments.run)
    net = load_network(arguments.checkpoint)
    threads, nuisances = arguments.threads, nuisances_of(arguments.checkpoint)
    batches = calibration_batches(arguments.calibration, threads, nuisances)
    network = FakeQuantized(net, quantize(net, batches))
    stream = SamplerStream(SEED, 0, threads, DROP_CAMERA_PROBABILITY, nuisances=nuisances)
    fine_tune(network, stream, steps, arguments.batch, arguments.learning_rate)
    stream.close()
    save(network, arguments.checkpoint, steps * arguments.batch, out)
    print(out)


if __name__ == "__main__":
    run_program(main)
