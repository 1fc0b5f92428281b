"""Measures accuracy on scenes that training never sees.

    /usr/bin/python3 -m training.evaluate training/runs/nano/checkpoint.pt
    /usr/bin/python3 -m training.evaluate training/runs/nano/checkpoint.pt --write models

The first form measures the float network with PyTorch on simulated scenes, or with `--nuscenes DIR
--scenes FILE` on every sample of these nuScenes scenes (the paper's Table I). The second form also
measures the model file in the folder on the daemon's own network and solvers. It writes the results
into that folder: NETWORK_results.json and the tables of the model card (README.md for nano,
NETWORK.md for other networks).
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

import torch
from torch import Tensor

from tooling.errors import run_program
from tooling.option_types import above_zero, positive
from training.checkpoint import load_network, read_checkpoint
from training.config import TrainingConfig
from training.data import Batch
from training.losses import intersection_over_union, pose_losses
from training.model import real_images, real_raster
from training.models.network import BevNetwork
from training.report import Results, write_results
from training.runtime import NativeNetwork, NativeSolver
from training.solver import PoseSolvers, Solution, standardise
from training.sources import nuscenes_batches, simulator_batches

# Runs a network: batch -> F_B, F_M and the logits of the perceived mask.
Inference = Callable[[Batch], tuple[Tensor, Tensor, Tensor]]
# Runs a solver: F_B, F_M -> the correction.
Solver = Callable[[Tensor, Tensor], Solution]
AXES = ("x", "y", "yaw")
CLASSES = ("divider", "crossing", "boundary")
NATIVE_SOLVERS = ("full-fft", "block", "decoupled", "decoupled+refine", "banded+refine")
_TO_REPORTED = torch.tensor([1.0, 1.0, 180.0 / math.pi])  # m, m, degrees


def _error_metrics(name: str, error: Tensor) -> dict[str, float]:
    metrics: dict[str, float] = {}
    for i, axis in enumerate(AXES):
        e = error[:, i].abs()
        metrics |= {
            f"{name}_{axis}_mae": e.mean().item(),
            f"{name}_{axis}_median": e.median().item(),
            f"{name}_{axis}_rmse": e.square().mean().sqrt().item(),
            f"{name}_{axis}_p90": e.quantile(0.9).item(),
            f"{name}_{axis}_bias": error[:, i].mean().item(),
        }
    return metrics


def _coverage_metrics(name: str, error: Tensor, sigma: Tensor, nll: Tensor) -> dict[str, float]:
    metrics: dict[str, float] = {}
    for i, axis in enumerate(AXES):
        e, s = error[:, i].abs(), sigma[:, i]
        metrics |= {
            f"{name}_{axis}_within_1_sigma": (e <= s).float().mean().item(),
            f"{name}_{axis}_within_3_sigma": (e <= 3 * s).float().mean().item(),
            f"{name}_{axis}_nll": nll[:, i].mean().item(),
        }
    return metrics


def float_inference(net: BevNetwork) -> Inference:
    """The trained network in PyTorch, not quantized."""
    net.eval()

    def infer(batch: Batch) -> tuple[Tensor, Tensor, Tensor]:
        images, raster = real_images(batch.images), real_raster(batch.raster_prior)
        return net(images, batch.index, batch.weight, raster)[:3]

    return infer


def torch_solvers(solvers: PoseSolvers) -> dict[str, Solver]:
    """The solvers that training differentiates, without the refinement."""

    def joint(bev: Tensor, features_map: Tensor) -> Solution:
        return Solution.of(solvers.joint(standardise(bev), standardise(features_map)))

    def decoupled(bev: Tensor, features_map: Tensor) -> Solution:
        return Solution.of(solvers.decoupled(standardise(bev), standardise(features_map), None))

    return {"joint": joint, "decoupled": decoupled}


@torch.no_grad()
def evaluate(
    infer: Inference, solvers: Mapping[str, Solver], batches: Iterable[Batch], device: torch.device
) -> dict[str, float]:
    """Per axis and solver: MAE, median, RMSE, 90th percentile and mean signed error (m, m,
    degrees), coverage and NLL. Also the errors of the prior and the IoU of each class."""
    errors: dict[str, list[Tensor]] = {name: [] for name in solvers}
    sigmas: dict[str, list[Tensor]] = {name: [] for name in solvers}
    nlls: dict[str, list[Tensor]] = {name: [] for name in solvers}
    prior: list[Tensor] = []
    overlap, union = torch.zeros(3), torch.zeros(3)
    for host_batch in batches:
        prior.append(-host_batch.correction * _TO_REPORTED)
        batch = host_batch.to(device)
        bev, features_map, perceived = infer(batch)
        for name, solve in solvers.items():
            solution = solve(bev, features_map)
            errors[name].append((solution.estimate - batch.correction).cpu() * _TO_REPORTED)
            sigmas[name].append(solution.deviation.cpu() * _TO_REPORTED)
            nlls[name].append(pose_losses(solution.posterior, batch.correction).cpu())
        found = intersection_over_union(perceived, real_raster(batch.raster_truth))
        overlap += found[0].cpu()
        union += found[1].cpu()
    metrics = _error_metrics("prior", torch.cat(prior))
    for name in solvers:
        error = torch.cat(errors[name])
        metrics |= _error_metrics(name, error)
        metrics |= _coverage_metrics(name, error, torch.cat(sigmas[name]), torch.cat(nlls[name]))
    for i, name in enumerate(CLASSES):
        metrics[f"iou_{name}"] = (overlap[i] / union[i].clamp(min=1)).item()
    return metrics


def summary(metrics: dict[str, float]) -> str:
    """One line per solver and one for the IoU."""

    def triple(solver: str, kind: str) -> str:
        return "/".join(f"{metrics[f'{solver}_{axis}_{kind}']:.3f}" for axis in AXES)

    solvers = [key.removesuffix("_x_nll") for key in metrics if key.endswith("_x_nll")]
    lines = [f"{'prior':15} MAE {triple('prior', 'mae')}"]
    lines += [
        f"{solver:15} MAE {triple(solver, 'mae')} median {triple(solver, 'median')} "
        f"RMSE {triple(solver, 'rmse')} p90 {triple(solver, 'p90')} bias {triple(solver, 'bias')} "
        f"1 sigma {triple(solver, 'within_1_sigma')} 3 sigma {triple(solver, 'within_3_sigma')} "
        f"NLL {triple(solver, 'nll')}"
        for solver in solvers
    ]
    iou = "/".join(f"{metrics[f'iou_{name}']:.3f}" for name in CLASSES)
    return "\n".join([*lines, f"{'IoU':15} {iou}"])


def evaluate_native(network: NativeNetwork, batches: list[Batch]) -> dict[str, float]:
    """The metrics of a model file on the daemon's own network and solvers."""
    solvers = {kind: NativeSolver(network, kind) for kind in NATIVE_SOLVERS}
    return evaluate(network, solvers, batches, torch.device("cpu"))


def trained_line_width_cells(checkpoint: Path) -> float:
    """The width of the map's lines with which a run was trained."""
    config = read_checkpoint(checkpoint)["config"]
    return config.get("line_width_cells", TrainingConfig.line_width_cells)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("checkpoint", type=Path)
    parser.add_argument("--samples", type=positive, default=512)
    parser.add_argument("--threads", type=positive, default=1)
    parser.add_argument("--raw", action="store_true", help="use the last weights, not the average")
    parser.add_argument("--write", type=Path, help="folder of the model file and its card")
    parser.add_argument("--nuscenes", help="folder of the data set that replaces the simulator")
    parser.add_argument("--nuscenes-version", default="", help="v1.0-*, if there are several")
    parser.add_argument("--scenes", default="", help="file with scene names; default: all scenes")
    parser.add_argument("--line-width-cells", type=above_zero, help="default: as in training")
    arguments = parser.parse_args()
    if arguments.nuscenes and arguments.write:
        wanted = "wanted the simulator's scenes, which the model card is about"
        parser.error(f"--write: found --nuscenes too, {wanted}")
    for option in ("scenes", "nuscenes_version", "line_width_cells"):
        if getattr(arguments, option) and not arguments.nuscenes:
            name = "--" + option.replace("_", "-")
            parser.error(f"{name}: found no --nuscenes, wanted the folder of the data set")
    torch.set_num_threads(arguments.threads)
    net = load_network(arguments.checkpoint, averaged=not arguments.raw)
    solvers = torch_solvers(net.solvers)
    device = torch.device("cpu")
    if arguments.nuscenes:
        every = nuscenes_batches(
            arguments.nuscenes,
            arguments.scenes,
            arguments.line_width_cells or trained_line_width_cells(arguments.checkpoint),
            arguments.threads,
            arguments.nuscenes_version,
        )
        print(summary(evaluate(float_inference(net), solvers, every, device)))
        return
    network = None
    if arguments.write:
        # Before the long evaluation, so that a missing file is named at once.
        network = NativeNetwork(arguments.write / f"{net.config.name}.onnx", arguments.threads)
    batches = simulator_batches(arguments.samples, arguments.threads)
    metrics = evaluate(float_inference(net), solvers, batches, device)
    print(f"float\n{summary(metrics)}", flush=True)
    if network is not None:
        int8_metrics = evaluate_native(network, batches)
        print(f"int8\n{summary(int8_metrics)}", flush=True)
        trained = read_checkpoint(arguments.checkpoint)["samples"]
        results = Results(trained, arguments.samples, metrics, int8_metrics)
        write_results(arguments.write, net.config.name, results)


if __name__ == "__main__":
    run_program(main)
