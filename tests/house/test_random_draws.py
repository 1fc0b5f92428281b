"""Holds random draws in an order that no compiler can change."""

from __future__ import annotations

import re
import unittest
from collections.abc import Iterator

from tests.house.test_documents import ROOT, tracked

DRAW = re.compile(r"\brandom_?(\(\))?\.(uniform|normal|integer|index|chance|bits)\(")
MOST_CHARACTERS = 600  # in the arguments of a call


def arguments(text: str) -> list[str]:
    """The arguments of a call, divided at the commas outside of inner brackets."""
    depth, parts = 0, [""]
    for character in text:
        depth += (character in "([{") - (character in ")]}")
        if character == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += character
    return parts


def calls(text: str) -> Iterator[tuple[int, str]]:
    """The line of each call in a source, and what is between its parentheses."""
    opened = []
    for position, character in enumerate(text):
        if character == "(":
            opened.append(position)
        elif character == ")" and opened:
            begin = opened.pop()
            is_call = begin > 0 and (text[begin - 1].isalnum() or text[begin - 1] in "_>")
            if is_call and position - begin < MOST_CHARACTERS:
                yield text.count("\n", 0, begin) + 1, text[begin + 1 : position]


def lines_with_two_draws(text: str) -> list[int]:
    """Lines of calls of which two arguments draw a random number."""
    return [
        line for line, inner in calls(text)
        if sum(bool(DRAW.search(argument)) for argument in arguments(inner)) > 1
    ]


class RandomDrawsTest(unittest.TestCase):
    def test_no_call_has_two_draws_among_its_arguments(self) -> None:
        """GCC evaluates arguments in another order on arm64, so the worlds would differ."""
        found = [
            f"{path.relative_to(ROOT)}:{line}"
            for path in tracked("*.h", "*.cpp")
            if path.relative_to(ROOT).parts[0] != "tests"
            for line in lines_with_two_draws(path.read_text())
        ]
        self.assertEqual(found, [], "store each draw in a variable of its own (sim/random.h)")

    def test_finds_two_draws(self) -> None:
        two = "Vector2d(random.normal(),\n random_.normal());"
        self.assertEqual(lines_with_two_draws(two), [1])
        self.assertEqual(lines_with_two_draws("f(random.normal(0, g(1)), {1, 2});"), [])


if __name__ == "__main__":
    unittest.main()
