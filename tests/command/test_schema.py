"""Compares the schemas with the readers: on shipped files, and on files with one change."""

from __future__ import annotations

import copy
import json
import os
import re
import subprocess
import unittest
from pathlib import Path
from typing import Any, Iterator

import jsonschema
import yaml

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ["BEVLOC_BIN"]) / "schema_verdicts"

REAL = """
cameras:
  driver: v4l2
  ids: {front_left: a, front: b, front_right: c, back_left: d, back: e, back_right: f}
  formats: [nv12, yuyv]
  rate_hz: 10
  memory: dmabuf
  controls:
    - {name: exposure, value: 80}
  exposure_ms: 8
  readout_ms: 12
  buffers: 6
  tolerance_ms: 20
  wait_ms: 100
  min_cameras: 3
  compensate_motion: true
calibration:
  rig: rig.yaml
  online: {enabled: true, max_rotation_deg: 0.5, max_translation_m: 0.1, file: learned.yaml}
map: {file: town.osm}
model: {file: nano.onnx}
solver:
  kind: banded+refine
  tracking: {x_range_m: 2, x_step_m: 0.2, y_range_m: 1, yaw_range_deg: 2, yaw_step_deg: 0.2}
  acquiring: {x_range_m: 4}
can:
  driver: socketcan
  interface: can0
  variant: fd
  localizer_base_id: 0x500
  vehicle_base_id: 0x400
  rear_track_m: 1.6
  secoc: {key_file: key, starts_file: starts}
tracker:
  gate_squared_distance: 21
  gnss_correlation_s: 40
  correction_correlation_m: [20, 80, 20]
health: {odometry_timeout_ms: 200, corrections_to_track: 10, max_yaw_sigma_deg: 0.5}
gpio:
  trigger: {chip: gpiochip0, line: 17, rate_hz: 10, pulse_ms: 1}
  fault: {chip: gpiochip0, line: FAULT, active: low}
  ignition: {chip: gpiochip0, line: KL15, debounce_ms: 200}
realtime:
  lock_memory: true
  capture: {fifo_priority: 20, cpus: [0]}
log: {level: debug}
"""

FAULTS = """
cameras: {driver: mock, rate_hz: 10}
calibration: {rig: rig.yaml}
map: {procedural_seed: 7}
model: {file: nano.onnx}
can: {driver: mock}
simulation:
  seed: 1
  duration_s: 60
  stops_s: [2, 7]
  pace: [{at_s: 0, pace: 0}, {at_s: 10, pace: -0.5}]
  conditions: {sun_azimuth_deg: 10, overcast: 0.5, exposure: 1}
  exposure_offsets_ms: [0, 1, 2, 3, 4, 5]
  faults:
    - {kind: camera_swapped, camera: front, with: back}
    - {kind: camera_dead, camera: front, from_s: 2, until_s: 4}
    - {kind: gnss_jump, east_m: 20, from_s: 1}
    - {kind: odometry_scaled, factor: 1.1}
    - {kind: map_of_elsewhere, seed: 3}
    - {kind: gnss_outage}
"""

RECEIVER = """
cameras: {driver: replay, recording: pictures}
calibration: {rig: rig.yaml}
map: {file: town.osm}
model: {file: nano.onnx}
can: {driver: socketcan, interface: can0}
gnss:
  driver: gpsd
  address: 127.0.0.1
  port: 2948
  device: /dev/ttyACM0
  antenna_m: [1.35, 0]
  timing: system_clock
  max_age_ms: 900
  min_sigma_m: 1
clock: {source: ntp, max_error_ms: 5}
record:
  directory: recordings
  images: raw
  jpeg_quality: 90
  file_s: 30
  max_mb: 1000
  max_age_h: 24
  black_box_files: 10
live: {address: 127.0.0.1, port: 8081, open_to_network: true}
"""

Place = tuple[Any, ...]


def paths(node: Any, here: Place = ()) -> Iterator[Place]:
    """The places of all values of a document."""
    if here:
        yield here
    if isinstance(node, list):
        node = dict(enumerate(node))
    if isinstance(node, dict):
        for key, value in node.items():
            yield from paths(value, (*here, key))


def changed(document: Any, place: Place, value: Any) -> Any:
    """A copy with another value at this place; without the place if the value is `...`."""
    result = copy.deepcopy(document)
    around = result
    for key in place[:-1]:
        around = around[key]
    if value is ...:
        del around[place[-1]]
    else:
        around[place[-1]] = value
    return result


def wrong_versions(document: Any) -> Iterator[tuple[str, Any]]:
    """Versions of a good document with one change, which may or may not be a mistake."""
    for place in paths(document):
        name = ".".join(str(key) for key in place)
        around = document
        for key in place[:-1]:
            around = around[key]
        if isinstance(around, dict):
            yield f"without {name}", changed(document, place, ...)
        for value in (-1e9, 1e9, 0.5, "no such word", True, [], [1, 2, 3, 4, 5], {}, None, ""):
            yield f"{name}: {value!r}", changed(document, place, value)
    for place in ((), *(p for p in paths(document))):
        inner = document
        for key in place:
            inner = inner[key]
        if isinstance(inner, dict):
            yield f"{place}: one key more", changed(document, (*place, "no_such_key"), 1)


def defaults_of_page() -> Iterator[tuple[str, Any]]:
    """The keys of docs/configuration.md with each default that is a value and no description."""
    headings: list[str] = []
    for line in (ROOT / "docs/configuration.md").read_text().splitlines():
        cells = [cell.strip() for cell in line.split("|")[1:-1]]
        if line.startswith("| key |"):
            headings = cells
        if not line.startswith("| `"):
            continue
        key = cells[0].strip("`").rpartition(".")[2]
        for heading, cell in zip(headings, cells, strict=True):
            if heading.startswith("default") and re.fullmatch(r"`.*`|-?[0-9.]+|\[.*\]", cell):
                yield key, yaml.safe_load(cell.strip("`"))


def defaults_of_schema(schema: Any) -> Iterator[tuple[str, Any]]:
    """The keys of a schema with their defaults."""
    for key, inner in schema.get("properties", {}).items():
        if "default" in inner:
            yield key, inner["default"]
        yield from defaults_of_schema(inner.get("items", inner))


def is_default(key: str, value: Any, defaults: list[tuple[str, Any]]) -> bool:
    """Whether the key has this default, to the digits that the page shows."""
    digits = len(str(value).partition(".")[2]) if isinstance(value, float) else 12
    same = [default for name, default in defaults if name == key]
    return any(
        round(default, digits) == value if isinstance(default, float) else default == value
        for default in same
    )


# What a schema cannot say: values that contradict each other, or that only a program understands.
BEYOND = re.compile(
    r"less than tolerance_ms|the id of another camera|more than a quarter of the range"
    r"|less than 0x40 apart|beside [0-9.]+ in gpio\.trigger\.rate_hz|a frame period or more"
    r"|not more than degraded_after_ms|half a period|a second time|an empty list|no known format"
    r"|a CPU listed twice|less than from_s|the same camera|the shortest time first"
    r"|wanted a whole number|a persistent camera id|quaternion|corners|cameras\.\w+\.vehicle_from"
    r"|cameras\.\w+\.f[xy]_px|distortion|rig cannot|cpus\[0\]|image_size_px|c[xy]_px|own_body_px"
    r"|an IP address in numbers|the path of a receiver|not more than latency_ms"
)


class SchemaTest(unittest.TestCase):
    schemas: dict[str, Any]

    @classmethod
    def setUpClass(cls) -> None:
        answer = subprocess.run([PROGRAM, "--schema"], check=True, stdout=subprocess.PIPE)
        cls.schemas = json.loads(answer.stdout)

    def verdicts(self, kind: str, documents: list[Any]) -> list[str]:
        """What the reader says about each document."""
        texts = [d if isinstance(d, str) else json.dumps(d) for d in documents]
        question = json.dumps({"config": [], "rig": [], kind: texts})
        pipe = subprocess.PIPE
        answer = subprocess.run([PROGRAM], input=question, check=True, stdout=pipe, text=True)
        return list(json.loads(answer.stdout)[kind])

    def accepts(self, schema: str, document: Any) -> bool:
        return not list(jsonschema.Draft7Validator(self.schemas[schema]).iter_errors(document))

    def test_schemas_are_schemas(self) -> None:
        for schema in self.schemas.values():
            jsonschema.Draft7Validator.check_schema(schema)

    def test_accept_every_shipped_file(self) -> None:
        configs = [ROOT / "config/demo.yaml", *sorted((ROOT / "tests/hil/config").glob("*.yaml"))]
        rigs = sorted((ROOT / "config").glob("rig_*.yaml"))
        self.assertGreaterEqual(len(configs), 4)
        self.assertGreaterEqual(len(rigs), 4)
        for kind, files in (("config", configs), ("rig", rigs)):
            validator = jsonschema.Draft7Validator(self.schemas[kind])
            for file in files:
                errors = validator.iter_errors(yaml.safe_load(file.read_text()))
                self.assertEqual([error.message for error in errors], [], file)

    def compare(self, kind: str, text: str) -> None:
        good = yaml.safe_load(text)
        self.assertEqual(self.verdicts(kind, [text]), [""])
        self.assertTrue(self.accepts(kind, good))
        versions = list(wrong_versions(good))
        found = self.verdicts(kind, [document for _, document in versions])
        refused = 0
        for (what, document), verdict in zip(versions, found, strict=True):
            accepted = self.accepts(kind, document)
            if verdict and accepted:
                self.assertRegex(verdict, BEYOND, f"the schema accepts {what}")
            if not accepted:
                refused += 1
                self.assertNotEqual(verdict, "", f"the schema refuses {what}")
        self.assertGreater(refused, len(versions) // 2)

    def test_real_cameras(self) -> None:
        self.compare("config", REAL)

    def test_simulation(self) -> None:
        self.compare("config", FAULTS)

    def test_gnss_receiver(self) -> None:
        self.compare("config", RECEIVER)

    def test_fixes_by_arrival(self) -> None:
        receiver = yaml.safe_load(RECEIVER)
        receiver["gnss"].update(timing="arrival", latency_ms=90, latency_sigma_ms=20)
        self.compare("config", json.dumps(receiver))
        del receiver["gnss"]["timing"]
        self.compare("config", json.dumps(receiver))

    def test_rig(self) -> None:
        self.compare("rig", (ROOT / "config/rig_fisheye.yaml").read_text())

    def test_keys_that_exclude_each_other(self) -> None:
        demo = yaml.safe_load(FAULTS)
        real = yaml.safe_load(REAL)
        receiver = yaml.safe_load(RECEIVER)
        for document in (
            {**demo, "map": {"procedural_seed": 7, "file": "a.osm"}},
            {**demo, "map": {}},
            {**demo, "gpio": real["gpio"]},
            {**demo, "can": {"driver": "mock", "interface": "can0"}},
            {**real, "map": {"procedural_seed": 7}},
            {**real, "can": {"driver": "mock"}},
            {**real, "simulation": demo["simulation"]},
            {**receiver, "gnss": {**receiver["gnss"], "latency_ms": 90}},
            {**receiver, "cameras": demo["cameras"], "simulation": demo["simulation"]},
        ):
            self.assertFalse(self.accepts("config", document), document)
            self.assertNotEqual(self.verdicts("config", [document]), [""], document)
        self.assertTrue(self.accepts("config", {**demo, "map": {"file": "a.osm"}}))

    def test_has_every_default_of_the_page(self) -> None:
        defaults = list(defaults_of_schema(self.schemas["config"]))
        on_page = list(defaults_of_page())
        self.assertGreater(len(on_page), 60)
        missing = [row for row in on_page if not is_default(*row, defaults)]
        self.assertEqual(missing, [])

    def test_vehicle_has_no_simulator(self) -> None:
        self.assertTrue(self.accepts("vehicle", yaml.safe_load(REAL)))
        self.assertFalse(self.accepts("vehicle", yaml.safe_load(FAULTS)))


if __name__ == "__main__":
    unittest.main()
