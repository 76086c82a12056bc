"""Anchors of headings as GitHub makes them, so that one link works there and in the manual."""


def github(text, _separator):
    return "".join(c for c in text.lower() if c.isalnum() or c in " -_").replace(" ", "-")
