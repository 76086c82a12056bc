"""Sections with chines that are driven deeper than their chines at default settings: how does the force scatter behind them?

usage: chines.py [BIN_DIR] [--spacing 0.01] [--only NAME]… [--set KEY=VALUE]…
       (default: build/bin, all sections; five minutes on one core)
Each section is 0.3 m wide at its chines, with sides 0.12 m high, and enters at 4 m/s with gravity. Flat bottoms stand in five places on the lattice. Printed are, for parts
of the time, the mean of the force, its rms about its running mean over that, and the least force of a window over it. Half the width of the running mean is a
fortieth of the run.
cases/VALIDATION.md, "Wedges and V sections at steps that resolve sound", "Behind chines"."""
import math
import statistics
import sys
import pathlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import runs

HALF, SIDE, PARTS = 0.15, 0.12, 6
SECTIONS = {"flat, sides of 60 degrees": (0, 60, 0.026), "V of 20, sides of 70": (20, 70, 0.045), "V of 20, upright sides": (20, 90, 0.045),
            "V of 30, upright sides": (30, 90, 0.045), "box": (0, 90, 0.03)}
CASE = """title = "section with chines"
end_time = {end}
[fluid]
dimension = 2
spacing = {spacing}
gravity = [0, -9.81]
tank = [[-0.8, -0.6], [0.8, 0.4]]
water = [[-0.8, -0.6], [0.8, 0]]
[structure]
solver = "rigid"
outline = {outline}
velocity = [0, -4]
"""


def outline(deadrise, side, x, gap):
    """Corners, counter-clockwise from the keel; the lowest stands `gap` over the water, the middle at x [m]."""
    chine = HALF * math.tan(math.radians(deadrise))
    top = HALF + SIDE / math.tan(math.radians(side))
    right = [(HALF, chine), (top, chine + SIDE)]
    corners = ([(0, 0)] if deadrise else []) + right + [(-u, v) for u, v in reversed(right)]
    return [[round(x + u, 6), round(gap + v, 6)] for u, v in corners]


def scatter(run):
    """For each part of the time: mean force [kN/m], rms about the running mean, and least force, over that mean."""
    force = run["force.y"]
    half = max(2, len(force) // 40)
    mean = [statistics.mean(force[max(0, k - half):k + half + 1]) for k in range(len(force))]
    found = []
    for part in range(1, PARTS):
        kept = range(part * len(force) // PARTS, (part + 1) * len(force) // PARTS)
        middle = statistics.mean(mean[k] for k in kept)
        found.append((middle / 1e3, statistics.pstdev([force[k] - mean[k] for k in kept]) / middle, min(force[k] for k in kept) / middle))
    return found


def main():
    parser = runs.command(__doc__)
    parser.add_argument("--spacing", type=float, default=0.01)
    parser.add_argument("--only", action="append", choices=list(SECTIONS), metavar="NAME", help="; ".join(SECTIONS))
    arguments = parser.parse_args()
    for name, (deadrise, side, end) in SECTIONS.items():
        if arguments.only and name not in arguments.only:
            continue
        places = [0.2 * k for k in range(5)] if name.startswith("flat") else [0.0]
        for place in places:
            corners = outline(deadrise, side, 0.0003 + place * arguments.spacing, 0.6 * arguments.spacing)
            run = runs.run(arguments.bin_dir, CASE.format(end=end, spacing=arguments.spacing, outline=corners), ["run.threads=1", *arguments.set])
            parts = ", ".join(f"{mean:.2f} ({rms:.2f}; {least:.2f})" for mean, rms, least in scatter(run))
            print(f"{name}, {place:.1f} l0 aside: {parts} kN/m", flush=True)


if __name__ == "__main__":
    main()
