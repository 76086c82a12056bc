"""Orders of convergence of the structure solvers, as a table and a picture.

usage: tests/benchmark/orders.py [BIN_DIR] [--keep DIR]
Runs structure_orders_benchmark: finite elements on a smooth manufactured solution and on the clamped strip, particles on
the free and the clamped strip. Prints each error with the order between it and the one before; --keep draws orders.svg."""
import collections
import math
import os
import subprocess

from drawing import COLOURS, Drawing
from runs import ENVIRONMENT, command


def measured(program):
    series = collections.defaultdict(list)
    text = subprocess.run([program], check=True, capture_output=True, text=True, env={**os.environ, **ENVIRONMENT}).stdout
    for line in text.splitlines():
        name, size, error = line.split(",")
        series[name].append((int(size), float(error)))
    return series


def order(before, after):
    return math.log(before[1] / after[1]) / math.log(after[0] / before[0])


def main():
    arguments = command(__doc__, keeps=True).parse_args()
    series = measured(arguments.bin_dir / "structure_orders_benchmark")
    for name, figures in series.items():
        print(f"\n{name}\n{'cells or layers':>16} {'error':>11} {'order':>7}")
        for k, (size, error) in enumerate(figures):
            print(f"{size:16d} {error:11.3e} {order(figures[k - 1], figures[k]) if k else math.nan:7.2f}")
    if not arguments.keep:
        return
    drawing = Drawing("Errors of the structure solvers", "cells or layers through the body, log2", "error, log10",
                      size=(860, 620))
    for k, (name, figures) in enumerate(series.items()):
        last = order(figures[-2], figures[-1])
        x, y = [math.log2(size) for size, _ in figures], [math.log10(error) for _, error in figures]
        drawing.line(x, y, f"{name}, order {last:.2f}", COLOURS[k % len(COLOURS)], dashed=k >= len(COLOURS))
    drawing.write(arguments.keep / "orders.svg")


if __name__ == "__main__":
    main()
