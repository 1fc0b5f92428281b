"""The configuration of a network, and the presets."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from training.solvers.definition import DEFINITION, SolverDefinition

CAMERAS = 6
RASTER_CHANNELS, RASTER_ROWS, RASTER_COLS = 3, 400, 200
RASTER_CELL_M = 0.15
# Cells of the view table and so of the view transform. The solver's cells may be finer.
VIEW_ROWS, VIEW_COLS, VIEW_CELL_M = 100, 50, 0.6
VIEW_SLOTS = 8  # of the view table: two cameras per cell, four bilinear neighbours each
FEATURE_STRIDE = 8

RESIDUAL_TRUNKS = ("nano", "small", "base")
PYRAMID_TRUNKS = ("resnet50", "efficientnet_b0")
VIEWS = ("lut", "kernel", "dense")
CHANNELS = (4, 16, 64)
REDUCTIONS = (1, 4)
_PYRAMID_STRIDE = 128  # of the coarsest level of the BiFPN


@dataclass(frozen=True)
class ModelConfig:
    """One network. Sizes are (rows, columns). ValueError if the parts do not fit together."""

    name: str
    trunk: str = "nano"
    view: str = "lut"
    width: int = 48  # channels of the image features and of the BEV features
    channels: int = 16  # C: channels of the features that the solver compares
    bev_size: tuple[int, int] = (100, 50)  # cells of the features that the solver compares
    image_size: tuple[int, int] = (96, 320)
    token_grid: tuple[int, int] | None = None  # pyramid trunks: image cells; None: stride 8
    bev_blocks: int = 1  # residual blocks of the BEV encoder
    map_widths: tuple[int, ...] = (16, 32)
    head_width: int = 32
    pyramid_width: int = 128  # channels of the BiFPN
    pyramid_cells: int = 3
    heads: int = 4  # of attention
    kernel_size: int = 3  # kernel view: kernel_size x kernel_size keys per camera
    query_grid: tuple[int, int] = (VIEW_ROWS, VIEW_COLS)  # dense view
    encoder_layers: int = 2  # dense view
    decoder_layers: int = 4  # dense view
    feedforward_width: int = 1024  # dense view
    position_width: int = 2048  # dense view: hidden channels of the positional encoding's MLP
    dropout: float = 0.1  # dense view

    def __post_init__(self) -> None:
        self._check(self.trunk in RESIDUAL_TRUNKS + PYRAMID_TRUNKS, "trunk", self.trunk)
        self._check(self.view in VIEWS, "view", self.view)
        self._check(self.channels in CHANNELS, "channels", self.channels)
        sizes = [(RASTER_ROWS // r, RASTER_COLS // r) for r in REDUCTIONS]
        self._check(self.bev_size in sizes, "bev_size", self.bev_size)
        self._check(
            self.width % (4 * self.heads) == 0,
            "width (wanted a multiple of 4 x heads)",
            self.width,
        )
        self._check(self.kernel_size % 2 == 1, "kernel_size (wanted odd)", self.kernel_size)
        stride = _PYRAMID_STRIDE if self.trunk in PYRAMID_TRUNKS else 2 * FEATURE_STRIDE
        self._check(
            all(pixels % stride == 0 for pixels in self.image_size),
            f"image_size (wanted multiples of {stride})",
            self.image_size,
        )
        self._check(
            self.token_grid is None or self.trunk in PYRAMID_TRUNKS,
            "token_grid (wanted none: this trunk has stride 8)",
            self.token_grid,
        )

    def _check(self, fits: bool, field: str, found: object) -> None:
        if not fits:
            raise ValueError(f"network '{self.name}': {field} cannot be {found}")

    @property
    def feature_grid(self) -> tuple[int, int]:
        """Cells of one camera's features, which the view table indexes."""
        rows, cols = (pixels // FEATURE_STRIDE for pixels in self.image_size)
        return self.token_grid or (rows, cols)

    @property
    def raster_reduction(self) -> int:
        """Raster cells along one side of a BEV cell."""
        return RASTER_ROWS // self.bev_size[0]

    @property
    def view_magnification(self) -> int:
        """BEV cells along one side of a cell of the view transform."""
        return self.bev_size[0] // VIEW_ROWS

    def solver_definition(self) -> SolverDefinition:
        rows, cols = self.bev_size
        cell_m = DEFINITION.rows * DEFINITION.cell_m / rows
        return replace(DEFINITION, rows=rows, cols=cols, cell_m=cell_m)


assert math.isclose(VIEW_ROWS * VIEW_CELL_M, RASTER_ROWS * RASTER_CELL_M)

# Where the paper leaves a size open, it is BeMapNet's (er-muyue/BeMapNet,
# configs/bemapnet_nuscenes_*.py).
_PAPER = ModelConfig(
    name="paper",
    trunk="resnet50",
    view="dense",
    width=512,
    image_size=(384, 896),
    token_grid=(21, 49),
    bev_blocks=0,
    map_widths=(64, 128),
    head_width=64,
    heads=8,
    query_grid=(64, 32),
)

PRESETS = {
    config.name: config
    for config in (
        ModelConfig(name="nano"),
        ModelConfig(name="small", trunk="small", view="kernel", width=64),
        ModelConfig(
            name="base",
            trunk="base",
            view="kernel",
            width=96,
            bev_blocks=2,
            map_widths=(32, 64),
            head_width=48,
            heads=6,
        ),
        replace(_PAPER, name="paper-resnet50", pyramid_width=120),
        replace(_PAPER, name="paper-efficientnet", trunk="efficientnet_b0"),
    )
}


def network_config(name: str, view: str = "") -> ModelConfig:
    """A preset, with another view transform if `view` names one. ValueError for unknown names."""
    if name not in PRESETS:
        raise ValueError(f"network: found '{name}', wanted one of {', '.join(PRESETS)}")
    preset = PRESETS[name]
    if view in ("", preset.view):
        return preset
    if view not in VIEWS:
        raise ValueError(f"view transform: found '{view}', wanted one of {', '.join(VIEWS)}")
    return replace(preset, name=f"{name}-{view}", view=view)
