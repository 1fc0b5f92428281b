"""Makes frames for the tests of the judge and of the scenarios."""

from tests.hil.lab import dbc


def protected(message: dbc.Message, **raw: int) -> str:
    """Returns the data of an intact frame with these raw values, as in a candump log."""
    word = 0
    for name, value in raw.items():
        signal = message.signals[name]
        word |= (value & ((1 << signal.bits) - 1)) << signal.start
    data = bytearray(word.to_bytes(message.length, "little"))
    data[0] = dbc._crc8_h2f(bytes(data[1:]) + bytes([message.data_id]))
    return data.hex().upper()
