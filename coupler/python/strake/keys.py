"""The key file of a participant (proto/WIRE.md, "Who may join"): NAME = "VALUE" a line, # begins a comment."""
import os
import re
import stat

from .errors import Error


def read_keys(path, name):
    """public, secret and coupler of a participant's file, each 40 characters of Z85; None where path is empty.

    Error where the file is not there, is open to others, or is the key of another participant.
    """
    if not path:
        return None
    fix = f"STRAKE_KEY must name the file {name}.key that `strake keys` made"
    try:
        mode = os.stat(path).st_mode
        with open(path, encoding="utf-8") as file:
            found = dict(re.findall(r'^\s*(\w+)\s*=\s*"([^"]*)"', file.read(), re.M))
    except (OSError, UnicodeDecodeError) as e:
        raise Error(f"cannot be read: {e}", fix, path, 2) from None
    if stat.S_IMODE(mode) & 0o077:
        raise Error("can be read by others", f"chmod 600 {path}", path, 2)
    if found.get("name", name) != name:
        raise Error(f'is the key of "{found["name"]}", and this participant is "{name}"', fix, path, 2)
    for word in ("public", "secret", "coupler"):
        if len(found.get(word, "")) != 40:
            raise Error(f'{word} = "…" of 40 characters is expected there', fix, path, 2)
    return {word: found[word].encode() for word in ("public", "secret", "coupler")}
