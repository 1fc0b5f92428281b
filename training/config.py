"""The options of a training run."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path

FIRST_TRAINING_SEED = 2**32  # evaluation seeds lie below it (sim/world/world_generator.h)
# A run has four samplers, or more if the number of its processes is not 1, 2 or 4. Each sampler has
# 2^28 seeds (SEED_STRIDE in training/data.py). So the seed of a run is a multiple of 2^30 or more
# (training/options.py), and runs with other seeds show other scenes. The first 2^26 seeds of each
# sampler are for the run itself. Each of these uses has 2^26 more, which begin this far after the
# run's own:
USUAL_SEEDS = 2**26  # samples with the usual nuisances of a run with usual_share
CALIBRATION_SEEDS = 2**27  # ranges of int8 and scales of the solvers
QAT_SEEDS = 3 * 2**26  # quantization-aware training
# Seeds of fixed sets, each far longer than its set:
FIRST_EVALUATION_SEED = 1_000_000  # the figures of the model card
FIRST_GOLDEN_SEED = 2_000_000  # golden vectors
FIRST_VALIDATION_SEED = 3_000_000  # validation during a run, which the early stop follows


@dataclass
class TrainingConfig:
    """The options of one run. Its budget is either `minutes` of wall-clock time or `samples`; the
    learning rate is annealed over the budget."""

    run: Path = Path("training/runs/nano")  # folder
    minutes: float = 0.0
    samples: int = 0
    stop_after_minutes: float = 0.0  # ends this process only; `resume` continues the run
    resume: bool = False
    init: str = ""  # checkpoint or float model file whose weights start a new run

    network: str = "nano"  # a preset of training/models/config.py
    view: str = ""  # view transform; empty: the preset's own

    nuscenes: str = ""  # folder of the data set; empty: samples come from the simulator
    nuscenes_version: str = ""  # v1.0-*; needed if the folder has several versions
    scenes: str = ""  # file with scene names; empty: all scenes
    validation_scenes: str = ""
    line_width_cells: float = 5.0
    on_error: str = "refuse"  # or "skip": what to do with unusable samples

    recordings: str = ""  # folder of recorded drives; empty: none
    map: str = ""  # HD map of the recorded drives
    rig: str = ""  # their calibration; empty: as recorded
    reference: str = "file"  # or "own", "truth": where their reference poses come from
    simulated_share: float = 0.5  # share of simulated samples in a run on recorded drives

    seed: int = FIRST_TRAINING_SEED
    batch: int = 8  # samples of all processes together
    threads: int = 1
    sampler_threads: int = 1
    precision: str = "auto"  # or float32, bfloat16
    drop_camera_probability: float = 0.15
    nuisances: str = "street"  # or "strong", "usual"; simulator only
    usual_share: float = 0.0  # share of the simulated samples that have usual nuisances
    photos: str = ""  # folder of script/photos; empty: textures of the simulator alone

    learning_rate: float = 2e-3
    scale_rate_factor: float = 5.0  # the softmax scales learn faster: they start far off
    final_rate: float = 0.01  # share of learning_rate
    warm_up_steps: int = 100  # 0: none
    anneal_from: float = 0.4  # share of the budget; 1: never
    weight_decay: float = 0.01
    clip_norm: float = 5.0
    ema_decay: float = 0.998

    semantic_stage: float = 0.03  # share of the budget for stage 1, which has no pose losses
    joint_weight: float = 0.1
    decoupled_weight: float = 0.1
    refined_weight: float = 0.1

    checkpoint_minutes: float = 2.0
    compact: bool = False  # checkpoints with 5 bytes for a weight (training/compact.py)
    validation_minutes: float = 6.0
    validation_samples: int = 96
    patience: int = 0  # stop after so many validations without improvement; 0: never
    patience_figure: str = "joint_x_mae"  # column of validation.csv that must improve
    log_steps: int = 25

    def budget_spent(self, elapsed_s: float, samples: int) -> float:
        """The share of the budget that is spent, 0 ... 1."""
        if self.samples > 0:
            return min(1.0, samples / self.samples)
        return min(1.0, elapsed_s / (60.0 * self.minutes))

    def as_dict(self) -> dict:
        return {key: str(v) if isinstance(v, Path) else v for key, v in asdict(self).items()}
