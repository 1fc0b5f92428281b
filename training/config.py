"""What a training run can choose."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path

FIRST_TRAINING_SEED = 2**32  # sim/world/world_generator.h: evaluation's seeds lie below it
FIRST_VALIDATION_SEED = 1_000_000
FIRST_GOLDEN_SEED = 2_000_000


@dataclass
class TrainingConfig:
    """One run. The budget is either wall-clock time or samples; the learning rate follows it."""

    run: Path = Path("training/runs/nano")
    minutes: float = 0.0
    samples: int = 0
    stop_after_minutes: float = 0.0  # of this process; the run goes on with `resume`
    resume: bool = False
    init: str = ""  # checkpoint whose averaged weights a new run begins with

    network: str = "nano"  # of training/models/config.py
    view: str = ""  # transform; none: the network's own

    nuscenes: str = ""  # folder of the data set; none: the simulator
    nuscenes_version: str = ""  # v1.0-*, where there are several
    scenes: str = ""  # file of scene names; none: all
    validation_scenes: str = ""
    line_width_cells: float = 5.0
    on_error: str = "refuse"  # or "skip": of samples that cannot be used

    seed: int = FIRST_TRAINING_SEED
    batch: int = 8  # of all processes together
    threads: int = 1
    sampler_threads: int = 1
    precision: str = "auto"  # or float32, bfloat16
    drop_camera_probability: float = 0.15
    nuisances: str = "strong"  # or "usual": of the simulator's samples

    learning_rate: float = 2e-3
    scale_rate_factor: float = 5.0  # the softmax scales have far to go
    final_rate: float = 0.01  # of learning_rate
    warm_up_steps: int = 100
    anneal_from: float = 0.4  # of the budget
    weight_decay: float = 0.01
    clip_norm: float = 5.0
    ema_decay: float = 0.998

    semantic_stage: float = 0.03  # of the budget: stage 1, semantic loss alone
    joint_weight: float = 0.1
    decoupled_weight: float = 0.1
    refined_weight: float = 0.1

    checkpoint_minutes: float = 2.0
    validation_minutes: float = 6.0
    validation_samples: int = 96
    patience: int = 0  # validations without a better figure until the run stops; 0: it does not
    patience_figure: str = "joint_x_mae"  # a column of validation.csv
    log_steps: int = 25

    def budget_spent(self, elapsed_s: float, samples: int) -> float:
        """The part of the budget that is spent, 0 ... 1."""
        if self.samples > 0:
            return min(1.0, samples / self.samples)
        return min(1.0, elapsed_s / (60.0 * self.minutes))

    def as_dict(self) -> dict:
        return {key: str(v) if isinstance(v, Path) else v for key, v in asdict(self).items()}
