"""Looks at the live page of a simulated drive with a real browser."""

from __future__ import annotations

import unittest

from evaluation.live import browser
from evaluation.live.drive import Drive

PICTURES = "document.querySelectorAll('figure img:not([hidden])').length === 6"
STATE = "document.getElementById('state')?.textContent"
STATES = ("INIT", "ACQUIRING", "TRACKING", "DEGRADED", "LOST", "FAULT")
DRAWN = """(id) => {
  const canvas = document.getElementById(id);
  const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
  return data.some((value) => value > 0);
}"""


@unittest.skipUnless(browser.program(), "no Chromium here (script/packages-web.txt)")
class LivePageTest(unittest.TestCase):
    def check_size(self, page: browser.Browser, width: int, height: int) -> None:
        page.resize(width, height)
        self.assertLessEqual(page.evaluate("document.documentElement.scrollWidth"), width)
        outside = page.evaluate(
            "[...document.querySelectorAll('header, section, figure, canvas, dl')].filter((part) =>"
            " part.getBoundingClientRect().right > innerWidth + 1).map((part) => part.outerHTML)"
        )
        self.assertEqual(outside, [])
        small = page.evaluate(
            "[...document.querySelectorAll('p, td, th, dd, dt, li, button, h2')].filter((part) =>"
            " parseFloat(getComputedStyle(part).fontSize) < 11).length"
        )
        self.assertEqual(small, 0, "text that is too small to read")

    def check_labels(self, page: browser.Browser) -> None:
        unnamed = page.evaluate(
            "[...document.querySelectorAll('img:not([alt]), button, canvas, section')].filter("
            "(part) => !part.textContent.trim() && !part.getAttribute('aria-label') &&"
            " part.getAttribute('aria-hidden') !== 'true').map((part) => part.outerHTML)"
        )
        self.assertEqual(unnamed, [])

    def test_it_loads_and_updates_without_errors(self) -> None:
        with Drive(duration_s=600) as drive, browser.Browser() as page:
            page.resize(1280, 800)
            page.open(drive.address + "/")
            page.wait_for(PICTURES)
            page.wait_for(f"{list(STATES)!r}.includes({STATE})")
            for canvas in ("bev", "trail"):
                page.wait_for(f"({DRAWN})('{canvas}')")
            place = page.evaluate("document.getElementById('place').textContent")
            page.wait_for(f"document.getElementById('place').textContent !== {place!r}")
            for width, height in ((1280, 800), (390, 844)):
                with self.subTest(width=width):
                    self.check_size(page, width, height)
            self.check_labels(page)
            page.evaluate("document.querySelector('[data-pose=both]').click()")
            pressed = page.evaluate("document.querySelectorAll('[aria-pressed=true]').length")
            self.assertEqual(pressed, 1)
            self.assertEqual(page.errors, [])
            status, metrics = drive.get("/metrics")
            self.assertEqual(status, 200)
            self.assertRegex(metrics, r"bevloc_framesets_total [1-9]")

    def test_it_says_when_the_daemon_has_ended(self) -> None:
        with browser.Browser() as page:
            with Drive(duration_s=600) as drive:
                page.open(drive.address + "/")
                page.wait_for(f"{list(STATES)!r}.includes({STATE})")
            page.wait_for(f"{STATE} === 'NO DATA'")


if __name__ == "__main__":
    unittest.main()
