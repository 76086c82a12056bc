"""The functions for C of Strake's libprecice.so.3 (coupler/precice/README.md). Their errors become exceptions."""
import atexit
import ctypes
import functools
import os
import pathlib
import re
import sys

import numpy as np

from strake.errors import Error as StrakeError
from strake.faults import OF_OTHERS, error_of

from .errors import Error

PACKAGES = pathlib.Path(__file__).resolve().parent.parent  # build/python_precice or share/strake/python_precice
HANDLER = ctypes.CFUNCTYPE(None, ctypes.c_char_p)


class Library:
    """The loaded library. One participant of a process speaks through it."""

    def __init__(self, file):
        self._library = ctypes.CDLL(str(file))
        self._errors = []
        self._take_error = HANDLER(lambda text: self._errors.append(text.decode(errors="replace")))  # the library keeps a pointer to it
        self._library.strake_precice_on_error(self._take_error)

    def call(self, function, *arguments, result=ctypes.c_int):
        """Calls precicec_<function>; Error with what the library says of it. result: the type that it returns."""
        called = self._library["precicec_" + function]
        called.restype = result
        found = called(*(for_c(argument) for argument in arguments))
        if self._errors:
            told, self._errors = self._errors[0], []
            raise Error(in_python(told))
        return found

    def drop(self):
        """Ends the participant's part in the run: before the run's end a fault of the solver."""
        self._library.strake_precice_drop()


def for_c(argument):
    if isinstance(argument, np.ndarray):
        return argument.ctypes.data_as(ctypes.c_void_p)
    return {str: lambda text: text.encode(), float: ctypes.c_double, int: ctypes.c_int}[type(argument)](argument)


def python_name(function):
    """setMeshVertices -> set_mesh_vertices"""
    return re.sub("IDs|[A-Z]", lambda begin: "_" + begin[0].lower(), function)


def in_python(text):
    """The text of an error with the names that calls have in Python."""
    return re.sub(r"(?:precice::)?\b([a-z]\w*)\(\)", lambda call: python_name(call[1]) + "()", text).replace("precice::", "")


@functools.cache
def library():
    """The library of this version, in a build or an installation. It learns of an exception that ends the program."""
    places = [prefix / "lib" / "strake" / "precice" / "libprecice.so.3" for prefix in (PACKAGES.parent, PACKAGES.parent.parent.parent)]
    file = next((place for place in places if place.exists()), None)
    if not file:
        raise Error(f"Participant(): there is no {places[-1]}; it belongs to Strake's programs")
    loaded = Library(file)
    previous_hook = sys.excepthook

    def on_exception(kind, problem, trace):
        os.environ["STRAKE_PRECICE_REASON"] = reason_of(problem)
        previous_hook(kind, problem, trace)

    sys.excepthook = on_exception
    atexit.register(loaded.drop)
    return loaded


def reason_of(problem):
    """Why the solver leaves, as STRAKE_PRECICE_REASON has it."""
    if isinstance(problem, (Error, StrakeError)):
        return str(problem)
    error = error_of(problem, (*OF_OTHERS, str(PACKAGES)))
    return f"{error.where}: {error.problem}\n  fix: {error.fix}"
