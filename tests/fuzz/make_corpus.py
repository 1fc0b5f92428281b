#!/usr/bin/python3
"""Writes the small inputs from which the fuzz targets start, into tests/fuzz/corpus/TARGET/.

Usage: make_corpus.py. It replaces only its own files; what libFuzzer found stays (script/fuzz).
"""

from __future__ import annotations

import ctypes
import io
import struct
import zlib
from pathlib import Path

from PIL import Image

CORPUS = Path(__file__).parent / "corpus"
SIZE = (16, 12)  # pixels, as tests/fuzz/targets/picture.cpp wants them


def write(target: str, name: str, data: bytes) -> None:
    folder = CORPUS / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(data)


# --- maps -----------------------------------------------------------------------------------------


def varint(value: int) -> bytes:
    data = bytearray()
    while value >= 0x80:
        data.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes(data) + bytes([value])


def zigzag(value: int) -> bytes:
    return varint(value << 1 if value >= 0 else ((-value) << 1) - 1)


class Body:
    """The body of a compact map (pipeline/map/map_binary.h)."""

    def __init__(self) -> None:
        name = b"fuzz"
        self.data = varint(len(name)) + name + struct.pack("<dd", 49.0, 8.4)
        self.last = [0, 0]

    def count(self, value: int) -> None:
        self.data += varint(value)

    def line(self, points: list[tuple[int, int]]) -> None:
        self.count(len(points))
        for point in points:
            for axis in range(2):
                self.data += zigzag(point[axis] - self.last[axis])
                self.last[axis] = point[axis]


def map_body() -> bytes:
    body = Body()
    body.count(3)
    for kind, look, line in (
        (0, 2, [(-30_000, 0), (0, 0), (30_000, 500)]),
        (1, 4, [(9_000, -4_000), (12_000, -4_000), (12_000, 4_000), (9_000, 4_000)]),
        (2, 6, [(-30_000, 4_000), (30_000, 4_500)]),
    ):
        body.data += bytes([kind, look])
        body.line(line)
    body.count(1)
    for y_mm in (0, 4_000, 2_000):
        body.line([(-30_000, y_mm), (30_000, y_mm + 500)])
    body.data += struct.pack("<d", 13.9)
    body.count(1)
    body.count(0)
    return body.data


# --- pictures -------------------------------------------------------------------------------------


def pictures() -> None:
    colour = Image.new("RGB", SIZE)
    for y in range(SIZE[1]):
        for x in range(SIZE[0]):
            colour.putpixel((x, y), (16 * x, 20 * y, 255 - 16 * x))
    for name, mode in (("rgb", "RGB"), ("grey", "L"), ("rgba", "RGBA"), ("palette", "P")):
        data = io.BytesIO()
        colour.convert(mode).save(data, "PNG")
        write("image_file", f"{name}.png", data.getvalue())
    for name, subsampling in (("444", 0), ("422", 1), ("420", 2), ("progressive", 2)):
        data = io.BytesIO()
        colour.save(data, "JPEG", quality=40, subsampling=subsampling,
                    progressive=name == "progressive")
        write("mjpeg", f"{name}.jpg", data.getvalue())
        if name in ("420", "progressive"):
            write("image_file", f"{name}.jpg", data.getvalue())
    data = io.BytesIO()
    colour.convert("L").save(data, "JPEG")
    write("mjpeg", "grey.jpg", data.getvalue())


# --- CAN ------------------------------------------------------------------------------------------


def raw_frame(identifier: int, length: int, data: bytes) -> bytes:
    """A byte that selects a raw frame, then a canfd_frame as targets/bus.cpp reads it."""
    return b"\0" + struct.pack("<IBBBB", identifier, length, 0, 0, 0) + data.ljust(64, b"\0")


def buses() -> None:
    write("can_frames", "raw", raw_frame(0x400, 8, bytes(range(8))) + raw_frame(0x20000088, 8, b""))
    # Any byte of 64 or more selects a message of the table and protects what follows.
    write("can_frames", "protected", b"".join(bytes([64 + i]) + bytes([i] * 6) for i in range(60)))
    write("can_frames", "zeros", bytes([75, 0, 0, 0, 0, 0, 0, 76]) + bytes(40))
    log = (
        "(1436509052.249713) can0 044#2A366C2BBA\n"
        "(1436509052.349713) can0 500##1000102030405060708\n"
        "\n"
        "(1436509052.449713123) vcan1 12345678#00\n"
        "(1436509052.549713) can0 123#R8\n"
        "(1436509052.649713) can0 20000088#0000000000000000\n"
    )
    write("candump", "kinds.log", log.encode())
    write("candump", "one.log", b"(0.000000) can0 7FF#\n")


# --- replay ---------------------------------------------------------------------------------------


def recordings() -> None:
    index = (
        "# sequence time_ns file\n0 1000000000 a.png\n\n"
        "1 1100000000 a.png # late\n7 1700000000 a.png\n"
    )
    write("frames_txt", "three.txt", index.encode())
    write("frames_txt", "one.txt", b"0 -5 a.png\r\n")


def text(value: str) -> bytes:
    return struct.pack("<I", len(value)) + value.encode()


def record(opcode: int, content: bytes) -> bytes:
    return struct.pack("<BQ", opcode, len(content)) + content


def chunk(records: bytes, packed: bytes, compression: str) -> bytes:
    head = struct.pack("<QQQI", 5, 9, len(records), zlib.crc32(records)) + text(compression)
    return record(6, head + struct.pack("<Q", len(packed)) + packed)


def zstd(data: bytes) -> bytes:
    library = ctypes.CDLL("libzstd.so.1")
    library.ZSTD_compress.restype = ctypes.c_size_t
    room = ctypes.create_string_buffer(1000)
    size = library.ZSTD_compress(
        room, ctypes.c_size_t(len(room)), data, ctypes.c_size_t(len(data)), 1
    )
    return room.raw[:size]


def mcap_files() -> None:
    magic = b"\x89MCAP0\r\n"
    start = magic + record(1, text("") + text("fuzz"))
    start += record(0x0C, text("bevloc") + struct.pack("<I", 10) + text("a") + text("b"))
    attachment = struct.pack("<QQ", 1, 1) + text("a.yaml") + text("") + struct.pack("<Q", 2) + b"{}"
    start += record(9, attachment + struct.pack("<I", zlib.crc32(attachment)))
    start += record(3, struct.pack("<H", 1) + text("S") + text("protobuf") + text("d"))
    channel = struct.pack("<HH", 1, 1) + text("/t") + text("protobuf") + struct.pack("<I", 0)
    start += record(4, channel)
    messages = b"".join(
        record(5, struct.pack("<HIQQ", 1, i, 5 + i, 5) + b"payload") for i in range(3)
    )
    plain = chunk(messages, messages, "")
    packed = chunk(messages, zstd(messages), "zstd")
    write("mcap", "no_end.mcap", start + plain + packed)
    begin = len(start + packed)
    index = struct.pack("<QQQQIQ", 5, 9, len(start), len(packed), 0, 0)
    index += text("zstd") + struct.pack("<QQ", len(packed), len(messages))
    summary = record(4, channel) + record(8, index)
    footer = struct.pack("<BQQQ", 2, 20, begin, 0)
    summary += footer
    end = summary + struct.pack("<I", zlib.crc32(summary)) + magic
    write("mcap", "whole.mcap", start + packed + end)


def main() -> None:
    write("bvm", "street.body", map_body())
    write("bvm", "empty.body", Body().data + b"\0\0")
    pictures()
    buses()
    recordings()
    mcap_files()


if __name__ == "__main__":
    main()
