"""Draws the figures of docs/images from the JSON files that `bevloc` writes (script/figures)."""
