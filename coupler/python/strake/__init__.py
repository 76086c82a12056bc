"""Strake in Python: results of a run, runs and studies started, and solvers of one's own (coupler/python/README.md)."""
from .errors import Error, RetrySmallerStep
from .quantities import Quantity

__all__ = ["Error", "Participant", "Quantity", "RetrySmallerStep", "Run", "Study", "open", "open_study", "run", "study"]

# Reading results needs no messages, and a solver no HDF5: each part is imported where it is first used.
PARTS = {"Participant": "participant", "Run": "run_folder", "open": "run_folder", "Study": "study_folder",
         "open_study": "study_folder", "run": "programs", "study": "programs"}


def __getattr__(name):
    import importlib
    if name == "__version__":
        try:
            return importlib.import_module(".version", __name__).VERSION  # the build writes it
        except ModuleNotFoundError:
            return "of a source tree"
    if name not in PARTS:
        raise AttributeError(f"module 'strake' has no attribute {name!r}")
    return getattr(importlib.import_module("." + PARTS[name], __name__), name)


def __dir__():
    return __all__
