"""Shows the live page in a real browser what a daemon could send, without a daemon."""

from __future__ import annotations

import base64
import functools
import http.server
import json
import re
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


class Server(http.server.ThreadingHTTPServer):
    """Serves the page. Each connection to /events gets the next answer, and then silence."""

    def __init__(self) -> None:
        handler = functools.partial(Files, directory=str(PAGE))
        super().__init__(("127.0.0.1", 0), handler)
        self.answers: list[bytes] = []
        self.asked = threading.Semaphore(0)
        self.ended = threading.Event()


class Files(http.server.SimpleHTTPRequestHandler):
    """Serves the files of the page. Without an answer for /events, that is not found."""

    def do_GET(self) -> None:
        assert isinstance(self.server, Server)
        if self.path != "/events" or not self.server.answers:
            super().do_GET()
            return
        self.wfile.write(self.server.answers.pop(0))
        self.server.asked.release()
        self.server.ended.wait()

    def do_HEAD(self) -> None:
        self.send_response(503)
        self.end_headers()

    def log_message(self, format: str, *arguments: Any) -> None:
        pass


def status(**changes: Any) -> dict[str, Any]:
    camera = {
        "used": True,
        "captured": 1,
        "lost": 0,
        "dropped": 0,
        "unreadable": 0,
        "failures": 0,
        "faults": [],
    }
    return {
        "version": "1",
        "phase": "running",
        "healthy": True,
        "health": "TRACKING",
        "state": "TRACKING",
        "valid": True,
        "why": [],
        "time_s": 1.0,
        "sent_s": 1.0,
        "pose": None,
        "rate_hz": 10.0,
        "latency_ms": {"median": 40.0, "p99": 50.0, "count": 1},
        "cameras": [{"name": name, **camera} for name in CAMERAS],
        "framesets": {"skipped": 0, "without_prior": 0, "refused": 0, "spread_ms": 0.1},
        "tracker": {"corrections": {"accepted": 1}},
        "vehicle": {
            "e2e_refused": 0,
            "frames_lost": 0,
            "incomplete": 0,
            "not_available": 0,
            "odometry_refused": 0,
            "slow_odometry": 0,
        },
        "can": {
            "condition": "active",
            "sent": 1,
            "received": 1,
            "send_dropped": 0,
            "receive_dropped": 0,
            "receive_overruns": 0,
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
POSE: dict[str, Any] = {
    "x_m": 0.0,
    "y_m": 0.0,
    "yaw_deg": 0.0,
    "speed_mps": 1.0,
    "sigma": {"longitudinal_m": 0.1, "lateral_m": 0.1, "yaw_deg": 0.1},
    "protection_level": {"longitudinal_m": 1.0, "lateral_m": 1.0, "yaw_deg": 1.0},
    "longitudinal_lateral_covariance_m2": 0.0,
}
# The parts of the page that the browser has written since watch().
WATCH = """window.written = new Set(); new MutationObserver((changes) => {
  for (const change of changes) {
    const place = change.target.parentElement.closest('[id]') || change.target;
    written.add(change.target.id || place.id || place.nodeName);
  }
}).observe(document, {subtree: true, childList: true, characterData: true})"""
# No time passes until LATER, so that the page does not notice that the test sends no events.
STILL = "performance.now = () => 0"
# What the page shows right after a status, before it can notice that the test sends no events.
AT_ONCE = """import('/status.js').then((m) => {
  performance.now = () => %f;
  m.onStatus(%s);
  return [document.title, document.getElementById('summary').textContent,
          document.body.classList.contains('stale')];
})"""
LATER = "(now => { performance.now = () => now + 4000; })(performance.now())"


def luminance(colour: str) -> float:
    """The relative luminance of a colour such as "rgb(1, 2, 3)", as WCAG defines it."""
    parts = [int(part) / 255 for part in re.findall(r"\d+", colour)[:3]]
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    dark, light = sorted((luminance(one), luminance(other)))
    return (light + 0.05) / (dark + 0.05)


@unittest.skipUnless(browser.program(), "no Chromium here (script/packages-web.txt)")
class PageTest(unittest.TestCase):
    def setUp(self) -> None:
        self.server = Server()
        self.addCleanup(self.server.server_close)
        self.addCleanup(self.server.shutdown)
        self.addCleanup(self.server.ended.set)
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        self.page = browser.Browser().__enter__()
        self.addCleanup(self.page.__exit__, None, None, None)
        self.page.open(f"http://127.0.0.1:{self.server.server_port}/page.html")
        self.page.wait_for("document.querySelectorAll('figure').length === 6")
        self.page.evaluate(STILL)

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

    def test_below_two_framesets_per_second_a_picture_waits_for_its_turn(self) -> None:
        def show(camera: str, at_s: float) -> None:
            self.page.evaluate(f"performance.now = () => {1000 * at_s}")
            self.tell("Camera", {**PICTURE, "camera": camera})
            self.call("page", "noteSilence")

        shown = "document.querySelectorAll('figure img:not([hidden])').length"
        for at_s, camera in enumerate(CAMERAS):
            show(camera, at_s)
            self.page.wait_for(f"{shown} === {at_s + 1}")
        first = "figure:nth-child(1)"
        self.assertFalse(self.has("old", first), "its turn comes now")
        for at_s in range(6, 12):
            show("back_right", at_s)
        self.assertTrue(self.has("old", first), "its turn has come twice")
        self.assertFalse(self.has("old", "figure:nth-child(6)"))

    def test_it_ends_a_connection_that_is_open_and_silent(self) -> None:
        head = b"HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\n\r\n"
        events = [f"event: status\ndata: {json.dumps(status(version=v))}\n\n" for v in ("2", "3")]
        # The first answer does not even begin.
        self.server.answers = [b"", *(head + event.encode() for event in events)]
        self.assertTrue(self.server.asked.acquire(timeout=120))
        for version, now_s in (("2", 60), ("3", 120)):
            self.page.evaluate(f"performance.now = () => {1000 * now_s}")
            shown = f"document.getElementById('version').textContent === 'bevloc {version}'"
            self.page.wait_for(shown)

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
                "sent_s": 1.0,
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

    def test_without_data_neither_title_nor_facts_look_current(self) -> None:
        self.tell("Status", status())
        self.assertEqual(self.page.evaluate("document.title"), "TRACKING · bevloc")
        opacity = "getComputedStyle(document.querySelector('.facts')).opacity"
        self.page.evaluate(LATER)
        self.call("page", "noteSilence")
        self.assertEqual(self.page.evaluate("document.title"), "NO DATA · bevloc")
        self.assertLess(float(self.page.evaluate(opacity)), 1.0)

    def test_a_slow_connection_does_not_look_current(self) -> None:
        def shown(at_s: float, sent_s: float) -> Any:
            message = json.dumps(status(sent_s=sent_s))
            return self.page.evaluate(AT_ONCE % (1000 * at_s, message))

        now = ["TRACKING · bevloc", "The pose may be used.", False]
        late = (
            "The page shows what was 18 s ago, because the connection or the browser is too slow."
        )
        self.assertEqual(shown(0, 1), now)
        self.assertEqual(shown(2, 1.5), now, "a delay of 1.5 s")
        self.assertEqual(shown(10, 2)[0], "LATE · bevloc")
        self.assertEqual(shown(20, 3), ["LATE · bevloc", late, True])
        self.assertEqual(shown(21, 21.5), now, "it has caught up")
        self.assertEqual(shown(90_000, 89_991.5), now, "a day later the clocks have drifted apart")

    def test_it_shows_images_that_are_unreadable_and_cameras_that_failed(self) -> None:
        bad = status()
        bad["cameras"][1].update(unreadable=23, failures=45)
        self.tell("Status", bad)
        row = "[...document.querySelectorAll('#frames tr:nth-child(2) td')].map(c => c.textContent)"
        self.assertEqual(
            self.page.evaluate(row), ["front", "yes", "0.0", "0", "0", "23", "45", "none"]
        )

    def test_it_shows_why_inputs_that_arrive_are_not_used(self) -> None:
        bad = status()
        bad["framesets"]["refused"] = 12
        bad["vehicle"].update(incomplete=23, not_available=34)
        bad["vehicle"].update(odometry_refused=45, slow_odometry=56)
        self.tell("Status", bad)
        for pair in (
            "framesets with too few images12",
            "vehicle epochs incomplete23",
            "vehicle epochs SNA or out of range34",
            "odometry implausible45",
            "odometry that came too rarely56",
        ):
            self.assertIn(pair, self.text("pairs"))

    def test_it_writes_only_what_differs(self) -> None:
        why = [{"reason": "GNSS missing", "do": "Check the antenna."}]
        self.tell("Status", status(why=why, pose=POSE))
        self.page.evaluate(WATCH)
        self.tell("Status", status(why=why, pose=POSE))
        self.tell("Status", status(why=why, pose=POSE, rate_hz=11.0))
        self.assertEqual(self.text("rate"), "11.0 Hz")
        self.assertEqual(self.page.evaluate("[...written]"), ["rate"])

    def test_the_trail_is_interrupted_where_there_was_no_pose(self) -> None:
        for x_m in (0.0, 1.0, None, 9.0, 10.0):
            pose = None if x_m is None else {**POSE, "x_m": x_m}
            self.tell("Status", status(pose=pose))
        trail = "import('/state.js').then(m => m.shown.trail.map(p => [p[0], p[3]]))"
        self.assertEqual(self.page.evaluate(trail), [[0, 0], [1, 0], [9, 1], [10, 0]])

    def test_the_badge_is_readable(self) -> None:
        for dark in (False, True):
            self.page.resize(1280, 800, dark)
            for kind in ("", "good", "warn", "bad"):
                with self.subTest(dark=dark, kind=kind):
                    self.page.evaluate(
                        f"document.getElementById('state').className = 'badge {kind}'"
                    )
                    colours = [
                        self.page.evaluate(
                            f"getComputedStyle(document.getElementById('state')).{name}"
                        )
                        for name in ("color", "backgroundColor")
                    ]
                    self.assertGreaterEqual(contrast(*colours), 4.5)

    def test_it_says_that_too_many_look(self) -> None:
        self.page.evaluate(LATER)
        full = "bevlocd has no room for another viewer"
        self.page.wait_for(f"document.getElementById('summary').textContent.includes('{full}')")


if __name__ == "__main__":
    unittest.main()
