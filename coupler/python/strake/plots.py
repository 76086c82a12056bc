"""Curves of a run with the references of its case, by matplotlib."""
from .errors import Error, need

CURVES = ("first_peak", "peak", "mean", "final")  # metrics that are values of the curve itself


def plot(run, columns, against="time", file=None, axes=None):
    """Draws columns of `run.history` over another one; returns matplotlib's axes.

    columns   names of columns; a probe's name draws all of its components
    file      where the picture is written, by its ending: png, svg, pdf; not given: nothing is written
    axes      axes to draw into; not given: new ones
    Error where a column does not exist or matplotlib is not installed.
    """
    names = [name for column in columns for name in expanded(run, column)]
    if not names:
        raise Error("plot() names no column", 'run.plot("force.y")', exit_code=2)
    x, values = run.column(against), [run.column(name) for name in names]
    units = run.units
    if axes is None:
        if file:
            need("matplotlib", "python3-matplotlib").use("Agg", force=False)
        axes = need("matplotlib.pyplot", "python3-matplotlib").subplots(layout="constrained")[1]
    for name, y in zip(names, values):
        axes.plot(x, y, label=f"{name} [{units[name]}]")
    for reference in run.references:
        if reference.probe in names and reference.metric in CURVES and reference.value is not None:
            axes.axhline(reference.value, linestyle=":", color="grey", label=f"{reference.name}, {reference.kind}")
    axes.set_xlabel(f"{against} [{units[against]}]")
    axes.set_title(run.folder.name)
    axes.legend()
    if file:
        axes.figure.savefig(file)
    return axes


def expanded(run, column):
    """A column itself, or the components of a probe: mid -> mid.x, mid.y."""
    table = run.history_table
    if column in table:
        return [column]
    return [name for name in table if name.startswith(column + ".") and name[len(column) + 1:] in "xyz"] or [column]
