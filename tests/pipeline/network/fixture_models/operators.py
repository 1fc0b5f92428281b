"""Models of single operators or small blocks. Each exists quantized and in float.

Scales are powers of two, so that int8 results are exact on every machine.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

from tests.pipeline.network.fixture_models.graph import Real
from tests.pipeline.network.fixture_models.model import Model


def operator_models(quantized: bool) -> Iterator[Model]:
    parts = (convolutions, residuals, sums, changes_of_size, rearrangements, concatenations, views)
    return chain.from_iterable(part(quantized) for part in parts)


def start(
    name: str, quantized: bool, kind: str = "uint8", shape: tuple[int, ...] = (2, 6, 9, 11)
) -> tuple[Model, Real]:
    """A model that has only its input."""
    model = Model(f"{name}_{'int8' if quantized else 'float'}", quantized)
    return model, model.input("x", kind, shape, 2.0**-6, seed=1)


def convolutions(quantized: bool) -> Iterator[Model]:
    model, x = start("conv", quantized, "int8")
    model.output(model.unit(x, 20, 2.0**-6), "y")
    yield model

    model, x = start("conv_strided", quantized)
    y = model.conv(x, 7, stride=2, pads=(1, 0, 1, 2), with_bias=False)
    model.output(model.quantize(y, "int8", 2.0**-5), "y")
    yield model

    model, x = start("conv_depthwise", quantized, shape=(1, 16, 8, 8))
    model.output(model.unit(x, 16, 2.0**-6, groups=16), "y")
    yield model

    model, x = start("conv_unrounded", quantized)
    model.output(model.conv(x, 5, size=1), "y")
    yield model


def residuals(quantized: bool) -> Iterator[Model]:
    model, x = start("residual", quantized)
    y = model.residual(model.unit(x, 16, 2.0**-6), 2.0**-5)
    model.output(model.residual(y, 2.0**-5), "y")
    yield model

    # The residual is read again at the end, so its memory must not be overwritten.
    model, x = start("residual_kept", quantized)
    y = model.unit(x, 16, 2.0**-6)
    z = model.residual(y, 2.0**-5)
    model.output(model.quantize(model.add(model.conv(z, 16), y), "int8", 2.0**-4), "y")
    yield model

    # The residual comes from a convolution and is int8, as in a strided block.
    model, x = start("residual_projected", quantized)
    y = model.unit(x, 16, 2.0**-6)
    skip = model.quantize(model.conv(y, 24, size=1, stride=2), "int8", 2.0**-5)
    inner = model.unit(y, 24, 2.0**-6, stride=2)
    z = model.relu(model.add(model.conv(inner, 24), skip))
    model.output(model.quantize(z, "uint8", 2.0**-5), "y")
    yield model

    model, x = start("residual_unrounded", quantized)
    model.output(model.residual(model.unit(x, 16, 2.0**-6), 2.0**-5, linear=True), "y")
    yield model


def sums(quantized: bool) -> Iterator[Model]:
    # Both terms are rounded before the sum, so nothing can be folded.
    model, x = start("add", quantized)
    y = model.quantize(model.conv(x, 8), "int8", 2.0**-5)
    z = model.unit(x, 8, 2.0**-6)
    model.output(model.quantize(model.relu(model.add(y, z)), "uint8", 2.0**-5), "y")
    yield model


def changes_of_size(quantized: bool) -> Iterator[Model]:
    model, x = start("max_pool", quantized)
    model.output(model.max_pool(model.unit(x, 16, 2.0**-6), 3, 2), "y")
    yield model

    # One step of a feature pyramid: adds the coarse level to the fine level.
    model, x = start("upsample_nearest", quantized, shape=(2, 6, 8, 12))
    fine = model.conv(model.unit(x, 16, 2.0**-6), 8, size=1)
    coarse = model.conv(model.unit(x, 16, 2.0**-6, stride=2), 8, size=1)
    up = model.upsample(model.quantize(coarse, "int8", 2.0**-5))
    model.output(model.quantize(model.relu(model.add(fine, up)), "uint8", 2.0**-5), "y")
    yield model

    model, x = start("upsample_linear", quantized)
    y = model.upsample(model.unit(x, 8, 2.0**-6), "linear")
    model.output(model.quantize(y, "uint8", 2.0**-5), "y")
    yield model


def rearrangements(quantized: bool) -> Iterator[Model]:
    model, x = start("depth_to_space_dcr", quantized, shape=(1, 6, 4, 5))
    y = model.depth_to_space(model.unit(x, 18, 2.0**-6), 3)
    model.output(model.unit(y, 4, 2.0**-6), "y")
    yield model

    model, x = start("depth_to_space_crd", quantized, shape=(1, 6, 4, 5))
    model.output(model.depth_to_space(model.conv(x, 12), 2, "CRD"), "y")
    yield model

    model, x = start("space_to_depth", quantized, shape=(1, 3, 8, 12))
    model.output(model.unit(model.space_to_depth(x, 2), 8, 2.0**-6), "y")
    yield model


def concatenations(quantized: bool) -> Iterator[Model]:
    model, x = start("concat", quantized)
    parts = [model.unit(x, 8, 2.0**-6), model.unit(x, 5, 2.0**-6)]
    model.output(model.unit(model.concat(parts), 4, 2.0**-6), "y")
    yield model

    # The scales differ, so the parts must be concatenated as real values.
    model, x = start("concat_rescaled", quantized)
    parts = [model.unit(x, 8, 2.0**-6), model.unit(x, 5, 2.0**-5)]
    y = model.quantize(model.concat(parts), "uint8", 2.0**-5)
    model.output(model.unit(y, 4, 2.0**-6), "y")
    yield model


def views(quantized: bool) -> Iterator[Model]:
    for channels_first in (False, True):
        name = "view_channels_first" if channels_first else "view_channels_last"
        model, x = start(name, quantized, shape=(3, 6, 4, 5))
        model.view_ports(21)
        y = model.view(model.unit(x, 20, 2.0**-6), 7, 3, channels_first)
        model.output(model.unit(model.quantize(y, "uint8", 2.0**-7), 4, 2.0**-6), "y")
        yield model
