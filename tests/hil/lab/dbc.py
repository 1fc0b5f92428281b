"""Reads a DBC file and decodes classic frames. Shares no code with the encoder."""

import dataclasses
import pathlib
import re

_MESSAGE = re.compile(r"BO_ (\d+) (\w+): (\d+) ")
_SIGNAL = re.compile(
    r" SG_ (\w+) : (\d+)\|(\d+)@1([+-]) \(([^,]+),([^)]+)\)"
)  # Intel byte order only
_NAMES = re.compile(r"VAL_ (\d+) (\w+) (.*);")
_CYCLE = re.compile(r'BA_ "GenMsgCycleTime" BO_ (\d+) (\d+);')
_DATA_ID = re.compile(r'BA_ "E2EDataId" BO_ (\d+) (\d+);')


@dataclasses.dataclass
class Signal:
    start: int
    bits: int
    signed: bool
    scale: float
    offset: float
    names: dict[int, str] = dataclasses.field(default_factory=dict)


@dataclasses.dataclass
class Message:
    name: str
    length: int
    signals: dict[str, Signal] = dataclasses.field(default_factory=dict)
    data_id: int = 0
    cycle_ms: int = 0

    def is_intact(self, data: bytes) -> bool:
        """Checks length and checksum by AUTOSAR E2E profile P02 (CRC-8H2F)."""
        return len(data) == self.length and data[0] == _crc8_h2f(data[1:] + bytes([self.data_id]))

    def decode(self, data: bytes) -> dict[str, float | str | None]:
        """Returns physical values, or names where the file has them; None means not available."""
        word = int.from_bytes(data, "little")
        values: dict[str, float | str | None] = {}
        for name, signal in self.signals.items():
            raw = (word >> signal.start) & ((1 << signal.bits) - 1)
            if signal.signed and raw >> (signal.bits - 1):
                raw -= 1 << signal.bits
            label = signal.names.get(raw)
            if label == "SNA":
                values[name] = None
            else:
                values[name] = label if label else raw * signal.scale + signal.offset
        return values


def read(path: pathlib.Path) -> dict[int, Message]:
    """Returns the messages of a DBC file by identifier."""
    messages: dict[int, Message] = {}
    message = None
    for line in path.read_text(encoding="utf-8").splitlines():
        if found := _MESSAGE.match(line):
            message = messages[int(found[1])] = Message(found[2], int(found[3]))
        elif (found := _SIGNAL.match(line)) and message:
            message.signals[found[1]] = Signal(
                int(found[2]), int(found[3]), found[4] == "-", float(found[5]), float(found[6])
            )
        elif found := _NAMES.match(line):
            pairs = re.findall(r'(-?\d+) "([^"]*)"', found[3])
            messages[int(found[1])].signals[found[2]].names = {int(k): v for k, v in pairs}
        elif found := _CYCLE.match(line):
            messages[int(found[1])].cycle_ms = int(found[2])
        elif found := _DATA_ID.match(line):
            messages[int(found[1])].data_id = int(found[2])
    return messages


def _crc8_h2f(data: bytes) -> int:
    crc = 0xFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = ((crc << 1) ^ 0x2F if crc & 0x80 else crc << 1) & 0xFF
    return crc ^ 0xFF
