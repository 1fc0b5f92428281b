"""Shows the live page in a real browser what a daemon could send, without a daemon."""

from __future__ import annotations

import base64
import functools
import http.server
import json
import threading
import unittest
from pathlib import Path
from typing import Any

from evaluation.live import browser

PAGE = Path(__file__).resolve().parents[3] / "firmware/live/page"
CAMERAS = ("front_left", "front", "front_right", "back_left", "back", "back_right")
PIXEL = base64.b64encode(
    bytes.fromhex("47494638396101000100800000000000ffffff2c00000000010001000002024401003b")
).decode()


class Files(http.server.SimpleHTTPRequestHandler):
    """Serves the files of the page, but no /events. The test tells the page what to show."""

    def do_HEAD(self) -> None:
        self.send_response(503)
        self.end_headers()

    def log_message(self, format: str, *arguments: Any) -> None:
        pass


def status(**changes: Any) -> dict[str, Any]:
    camera = {"used": True, "captured": 1, "lost": 0, "dropped": 0, "faults": []}
    return {
        "version": "1",
        "phase": "running",
        "healthy": True,
        "health": "TRACKING",
        "state": "TRACKING",
        "valid": True,
        "why": [],
        "time_s": 1.0,
        "pose": None,
        "rate_hz": 10.0,
        "latency_ms": {"median": 40.0, "p99": 50.0, "count": 1},
        "cameras": [{"name": name, **camera} for name in CAMERAS],
        "framesets": {"skipped": 0, "without_prior": 0, "spread_ms": 0.1},
        "tracker": {"corrections": {"accepted": 1}},
        "vehicle": {"e2e_refused": 0, "frames_lost": 0},
        "can": {
            "condition": "active",
            "sent": 1,
            "received": 1,
            "send_dropped": 0,
            "receive_dropped": 0,
            "error_frames": 0,
        },
        "memory_mb": 100.0,
        "cpu_s": 1.0,
        **changes,
    }


PICTURE = {
    "camera": "front",
    "width_px": 1,
    "height_px": 1,
    "used": True,
    "jpeg": PIXEL,
    "prior": [],
    "corrected": [],
}
DISTRIBUTION = {"step": 1.0, "probability": [0.2, 0.6, 0.2]}
MATCH = {
    "evidence": True,
    "score": 0.3,
    "mask": "0000",
    "mask_cols": 2,
    "mask_cell_m": 0.3,
    "prior": [],
    "corrected": [],
    "correction": [0, 0, 0],
    "x": DISTRIBUTION,
    "y": DISTRIBUTION,
    "yaw": DISTRIBUTION,
}
MODULES = {"Camera": "cameras", "Match": "match", "Status": "status"}
LATER = "(now => { performance.now = () => now + 4000; })(performance.now())"


@unittest.skipUnless(browser.program(), "no Chromium here (script/packages-web.txt)")
class PageTest(unittest.TestCase):
    def setUp(self) -> None:
        handler = functools.partial(Files, directory=str(PAGE))
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        self.page = browser.Browser().__enter__()
        self.addCleanup(self.page.__exit__, None, None, None)
        self.page.open(f"http://127.0.0.1:{server.server_port}/page.html")
        self.page.wait_for("document.querySelectorAll('figure').length === 6")

    def tell(self, name: str, data: dict[str, Any]) -> None:
        self.call(MODULES[name], f"on{name}", json.dumps(data))

    def call(self, module: str, function: str, argument: str = "") -> None:
        """Calls a function that one of the page's modules exports."""
        self.page.evaluate(f"import('/{module}.js').then(m => void m.{function}({argument}))")

    def text(self, part: str) -> str:
        return str(self.page.evaluate(f"document.getElementById('{part}').textContent"))

    def has(self, name: str, of: str) -> bool:
        classes = f"document.querySelector('{of}').classList"
        return bool(self.page.evaluate(f"{classes}.contains('{name}')"))

    def test_it_shows_which_camera_is_not_used(self) -> None:
        self.tell("Camera", PICTURE)
        self.tell("Status", status())
        self.assertFalse(self.has("unused", "figure:nth-child(2)"))
        without = status()
        without["cameras"][1]["used"] = False
        self.tell("Status", without)
        self.assertTrue(self.has("unused", "figure:nth-child(2)"))
        self.assertFalse(self.has("unused", "figure:nth-child(1)"))

    def test_it_greys_what_nothing_newer_replaced(self) -> None:
        self.tell("Camera", PICTURE)
        self.tell("Match", MATCH)
        self.page.wait_for("!document.querySelector('figure:nth-child(2) img').hidden")
        self.call("page", "noteSilence")
        for part in ("figure:nth-child(2)", "#bev", "#plots"):
            self.assertFalse(self.has("old", part), part)
        self.page.evaluate(LATER)
        self.call("page", "noteSilence")
        for part in ("figure:nth-child(2)", "#bev", "#plots"):
            self.assertTrue(self.has("old", part), part)
        self.assertFalse(self.has("old", "figure:nth-child(1)"), "never had a picture")
        self.tell("Match", MATCH)
        self.call("page", "noteSilence")
        self.assertFalse(self.has("old", "#bev"))

    def test_it_clears_the_facts_in_standby(self) -> None:
        self.tell("Status", status())
        self.assertEqual(self.text("rate"), "10.0 Hz")
        self.tell(
            "Status",
            {
                "version": "1",
                "phase": "standby",
                "healthy": True,
                "health": "standby: ignition off",
                "valid": False,
            },
        )
        for part in ("rate", "latency", "speed", "can", "place"):
            self.assertEqual(self.text(part), "–", part)
        self.assertEqual(self.text("frames") + self.text("pairs"), "")
        self.assertEqual(self.text("summary"), "standby: ignition off")

    def test_it_says_why_the_daemon_is_not_healthy(self) -> None:
        silent = "the supervisor has said nothing for 3 s. Restart the service."
        self.tell("Status", status(valid=False, healthy=False, health=silent))
        self.assertEqual(
            self.text("summary"), "The pose must not be used. Not healthy: " + silent
        )

    def test_it_says_that_too_many_look(self) -> None:
        self.page.evaluate(LATER)
        full = "As many viewers as bevlocd allows look already"
        self.page.wait_for(f"document.getElementById('summary').textContent.includes('{full}')")


if __name__ == "__main__":
    unittest.main()
