"""Looks at the live page with a browser: for its test and its screenshots."""
