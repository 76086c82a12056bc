"""The quantities that Strake knows (proto/WIRE.md, "Quantities and units")."""
from typing import NamedTuple


class Quantity(NamedTuple):
    """One quantity that crosses the interface.

    conservative   mapped so that sums over the points are kept, as of forces; else constants are kept
    """

    name: str
    unit: str
    components: int
    conservative: bool = False


KNOWN = {q.name: q for q in (
    Quantity("displacement", "m", 3), Quantity("velocity", "m/s", 3), Quantity("force", "N", 3, True),
    Quantity("traction", "Pa", 3), Quantity("pressure", "Pa", 1))}
SENT_BY = {"structure": "displacement", "fluid": "force", "attachment": "force"}  # where a participant names nothing else
RECEIVED_BY = {"structure": ("force",), "fluid": ("displacement", "velocity")}  # of Strake's own solvers


def quantity(name):
    """The quantity of that name, or a Quantity as it is; Error where Strake does not know the name."""
    from .errors import Error, nearest
    if isinstance(name, Quantity):
        return name
    if name in KNOWN:
        return KNOWN[name]
    raise Error(f'"{name}" is no quantity that Strake knows; {nearest(name, KNOWN)}',
                f'strake.Quantity("{name}", unit, components) announces one of your own')
