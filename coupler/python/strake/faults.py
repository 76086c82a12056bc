"""An exception that a solver did not catch, as what the coupler is told."""
import pathlib
import sysconfig
import traceback

import numpy as np

from .errors import Error

# Folders of Python's library, of packages and of this one. An exception is named by a line outside of them.
OF_OTHERS = ("<", *(str(pathlib.Path(path)) for path in (
    pathlib.Path(__file__).resolve().parent, sysconfig.get_path("stdlib"), pathlib.Path(np.__file__).parent.parent)))


def error_of(problem, others=OF_OTHERS):
    """An exception of a solver as an Error with the line that raised it. others: the begins of paths that are not the solver's."""
    if isinstance(problem, Error):
        return problem
    raised = traceback.extract_tb(problem.__traceback__)
    inside = [frame for frame in raised if not frame.filename.startswith(others)] or raised
    where = f"{pathlib.Path(inside[-1].filename).name}:{inside[-1].lineno}, in {inside[-1].name}" if inside else ""
    text = str(problem)
    return Error(f"{type(problem).__name__}{': ' + text if text else ''}", "its traceback stands in the solver's log", where)
