"""The names of preCICE's Python bindings, for solvers that are coupled by Strake (coupler/python/README.md).

It is no part of preCICE: a program that `strake run` starts finds it, and speaks to Strake's coupler through it.
"""
import pathlib
import sys

try:
    import strake  # noqa: F401
except ImportError:  # it lies in the folder beside: python_precice/precice, python/strake
    sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent.parent / "python"))

from .errors import Error  # noqa: E402
from .participant import Participant, get_version_information  # noqa: E402

__all__ = ["Error", "Participant", "get_version_information"]
__version__ = "3.4.1"  # whose names these are
