"""Whole networks: one that is computed, one for measurements, and two that Network refuses."""

from __future__ import annotations

import numpy as np

from tests.pipeline.network.fixture_models.graph import Real
from tests.pipeline.network.fixture_models.model import Model

NETWORK_STRIDE = 61  # kStride of network_test.cpp


def solver_metadata(model: Model) -> None:
    values = {"joint_scale": "150.5", "x_scale": "90", "y_scale": "120", "yaw_scale": "2000",
              "gem_omega": "1.25"}
    model.metadata = {f"bevloc.solver.{key}": value for key, value in values.items()}


def tiny_network(quantized: bool) -> Model:
    """All parts of the shipped network, with few channels and scales other than powers of two."""
    model = Model(f"tiny_network_{'int8' if quantized else 'float'}", quantized, odd_scales=True)
    model.rng = np.random.default_rng(7)
    s = 1.0 / 50.0
    images = model.input("images", "int8", (6, 3, 96, 320), 1.0 / 64.0, seed=1)
    model.view_ports(5000)
    raster = model.input("raster", "uint8", (1, 3, 400, 200), 1.0 / 255.0, seed=2,
                         declared=(3, 400, 200))

    x8 = model.unit(model.unit(model.unit(images, 8, s, stride=2), 8, s, stride=2), 8, s, stride=2)
    x8 = model.residual(x8, s)
    coarse = model.quantize(model.conv(model.unit(x8, 8, s, stride=2), 8, size=1), "int8", 2 * s)
    x8 = model.add(model.conv(x8, 8, size=1), model.upsample(coarse))
    x8 = model.quantize(model.relu(x8), "uint8", s)
    bev = model.residual(model.quantize(model.view(x8, 100, 50), "uint8", 0.37 * s), s)
    model.output(model.residual(model.unit(bev, 16, s, size=1), s, linear=True), "bev_features",
                 NETWORK_STRIDE)

    encoded = model.unit(model.unit(model.space_to_depth(raster, 2), 8, s), 8, s, stride=2)
    model.output(model.residual(model.unit(encoded, 16, s, size=1), s, linear=True),
                 "map_features", NETWORK_STRIDE)

    logits = model.conv(model.unit(bev, 8, s), 48, size=1)
    model.output(model.depth_to_space(logits, 4, "CRD"), "bev_mask", NETWORK_STRIDE)
    solver_metadata(model)
    return model


def nano_network() -> Model:
    """A network of the shipped size (training/model.py) with random weights. Not computed."""
    model = Model("nano-random", quantized=True, evaluate=False, odd_scales=True)
    s = 1.0 / 50.0
    images = model.input("images", "int8", (6, 3, 96, 320), 1.0 / 64.0, seed=1)
    model.view_ports(5000)
    raster = model.input("raster", "uint8", (1, 3, 400, 200), 1.0 / 255.0, seed=2)

    def compress(x: Real) -> Real:
        x = model.residual(model.residual(model.unit(x, 16, s), s), s)
        return model.residual(x, s, linear=True)

    x4 = model.residual(model.unit(model.unit(images, 12, s, stride=2), 24, s, stride=2), s)
    x8 = model.residual(model.residual(model.unit(x4, 40, s, stride=2), s), s)
    x16 = model.residual(model.residual(model.unit(x8, 80, s, stride=2), s), s)
    up = model.upsample(model.quantize(model.conv(x16, 48, size=1), "int8", s))
    merged = model.relu(model.add(model.conv(x8, 48, size=1), up))
    features = model.unit(model.quantize(merged, "uint8", s), 48, s)
    bev = model.residual(model.quantize(model.view(features, 100, 50), "uint8", s), s)
    model.output(compress(bev), "bev_features")

    encoded = model.unit(model.unit(model.space_to_depth(raster, 2), 16, s), 32, s, stride=2)
    model.output(compress(model.unit(encoded, 48, s)), "map_features")

    logits = model.conv(model.unit(bev, 32, s), 48, size=1)
    model.output(model.depth_to_space(logits, 4, "CRD"), "bev_mask")
    solver_metadata(model)
    return model


def wrong_shape() -> Model:
    """A model whose images do not have the size that Network requires."""
    model = Model("wrong_shape", quantized=True)
    x = model.input("images", "int8", (6, 3, 4, 4), 1.0 / 64.0, seed=1)
    model.output(model.conv(x, 2), "bev_features")
    return model


def small_features() -> Model:
    """A model with the ports that Network requires, but with image features of half the size."""
    model = Model("small_features", quantized=True, evaluate=False)
    s = 1.0 / 50.0
    images = model.input("images", "int8", (6, 3, 96, 320), 1.0 / 64.0, seed=1)
    model.view_ports(5000)
    raster = model.input("raster", "uint8", (1, 3, 400, 200), 1.0 / 255.0, seed=2)
    bev = model.quantize(model.view(model.unit(images, 4, s, stride=16), 100, 50), "uint8", s)
    model.output(model.conv(bev, 16, size=1), "bev_features")
    model.output(model.conv(raster, 16, stride=4), "map_features")
    model.output(model.depth_to_space(model.conv(bev, 48, size=1), 4), "bev_mask")
    solver_metadata(model)
    return model
