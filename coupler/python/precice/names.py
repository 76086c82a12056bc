"""Data of a precice-config.xml as quantities of Strake."""
import os

from strake.quantities import KNOWN, Quantity

from .errors import Error

VARIABLE = "STRAKE_PRECICE_NAMES"  # Force=force;Displacement=displacement


def read_names():
    """Name of a data -> name of a quantity, out of the environment."""
    names = {}
    for part in filter(None, (p.strip() for p in os.environ.get(VARIABLE, "").split(";"))):
        data, equals, quantity = (word.strip() for word in part.partition("="))
        if not (data and equals and quantity):
            raise Error(f'{VARIABLE}: "{part}" is no pair, expected like Force=force;Displacement=displacement')
        names[data] = quantity
    return names


def quantity_of(data, dimensions, is_conservative, names):
    """Returns the quantity of a data. The environment names it, else its lower-case name does, else it is one of its own.

    Error where a scalar stands for a vector of Strake, or a vector for a scalar.
    """
    name = names.get(data.name, data.name.lower() if data.name.lower() in KNOWN else data.name)
    if name not in KNOWN:
        return Quantity(name, "1", dimensions if data.is_vector else 1, is_conservative)
    if (KNOWN[name].components == 3) != data.is_vector:
        raise Error(f'the data "{data.name}" is a {"vector" if data.is_vector else "scalar"}, the quantity {name} of Strake is not; '
                    f"{VARIABLE} says which quantity a data is")
    return KNOWN[name]
