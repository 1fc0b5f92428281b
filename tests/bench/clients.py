"""Clients of the live page: a viewer, and hostile ones.

Each runs until its process is killed. All give way to every other process on this machine, so
that a benchmark measures what they cost the daemon, and not the processor time that they take.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import resource
import socket
import threading
import time
from collections.abc import Callable, Iterator

_HOST = "127.0.0.1"
_RETRY_S = 0.05
_EVENTS = b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n"
_MALFORMED = (
    b"\r\n\r\n",
    b"GET\r\n\r\n",
    b"GET / HTTP/9.9\r\n\r\n",
    b"GET / HTTP/1.1\r\nno colon\r\n\r\n",
    b"\x16\x03\x01\x02\x00\x01 tls\r\n\r\n",
    b"GET /../../etc/passwd HTTP/1.1\r\nHost: localhost\r\n\r\n",
    b"\0" * 100 + b"\r\n\r\n",
)
_HUGE = b"GET / HTTP/1.1\r\nHost: localhost\r\nX: " + b"a" * (1 << 20)
_IDLE = 1000
_SLOW = 40
_UNREAD = 4


def _connect(port: int) -> socket.socket:
    """Waits until the daemon listens."""
    while True:
        with contextlib.suppress(OSError):
            return socket.create_connection((_HOST, port), timeout=10)
        time.sleep(_RETRY_S)


def _ask(port: int, request: bytes) -> None:
    """Sends a request and reads the whole answer."""
    with contextlib.suppress(OSError), _connect(port) as client:
        client.sendall(request)
        while client.recv(1 << 16):
            pass


def view(port: int) -> None:
    """Reads the events of the page, as a browser that shows the page does."""
    while True:
        _ask(port, _EVENTS)


def _send_huge(port: int) -> None:
    while True:
        _ask(port, _HUGE)


def _send_malformed(port: int) -> None:
    while True:
        for request in _MALFORMED:
            _ask(port, request)


def _send_slowly(port: int) -> None:
    """Sends one byte every 0.1 s."""
    request = b"GET / HTTP/1.1\r\nHost: localhost\r\nX: " + b"a" * 100_000
    while True:
        with contextlib.suppress(OSError), _connect(port) as client:
            for k in range(len(request)):
                client.sendall(request[k : k + 1])
                time.sleep(0.1)


def _ask_without_reading(port: int) -> None:
    while True:
        with _connect(port) as client:
            client.sendall(_EVENTS)
            time.sleep(5.0)


def _stay_silent(port: int) -> None:
    """Opens connections, the oldest of which gives way to a new one."""
    connections: list[socket.socket] = []
    while True:
        connections.append(_connect(port))
        if len(connections) == _IDLE:
            connections.pop(0).close()
            time.sleep(0.01)


def attack(port: int) -> None:
    """Runs every kind of hostile client at once."""
    kinds: list[Callable[[int], None]] = [_send_huge, _send_malformed, _stay_silent]
    kinds += [_send_slowly] * _SLOW + [_ask_without_reading] * _UNREAD
    for kind in kinds:
        threading.Thread(target=kind, args=(port,), daemon=True).start()
    threading.Event().wait()


def _give_way(client: Callable[[int], None], port: int) -> None:
    os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
    client(port)


@contextlib.contextmanager
def running(client: Callable[[int], None], port: int) -> Iterator[None]:
    """Runs a client in a process of its own."""
    process = multiprocessing.Process(target=_give_way, args=(client, port), daemon=True)
    process.start()
    try:
        yield
    finally:
        process.kill()
        process.join()
