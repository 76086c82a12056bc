"""Whole-command cost of a 2-D dam break: wall seconds per sqrt(H/g), beside what other particle codes need.

usage: tests/benchmark/dam_break.py [BIN_DIR] [--particles N]… [--threads N]… [--units T] [--set KEY=VALUE]…
       (default: build/bin, 10 000 particles, 1 and 2 threads, 8 units)
The case is that of SPHinXsys, with g = 9.81 m/s^2 in place of 1 and the tank's length rounded to whole particles. The
column is 2 m wide and H = 1 m high, the tank 5.366 m long and open at 4 m; walls are smooth, the water is
incompressible. Every frame of 0.1 units is written. Other machines differ: beside each figure stands the time of a
particle-step as so many plain sparse products per row, and as the bytes that STREAM triad would have moved. Shortest of
--repeats runs, since what else runs on the machine only ever adds."""
import math
import subprocess

import runs

# seconds per sqrt(H/g) with 1 and 2 threads, on 2 virtual cores of 3.9 GHz. Triad 29 and 58 GB/s (48 MB)
PEERS = {
    10_000: {"SPHinXsys": (9.7, 5.1), "DualSPHysics 5.4 Verlet": (73, 38), "MPS-Basic (dt 2.5e-4, 12.6k)": (195, 146)},
    100_000: {"SPHinXsys": (424, 221), "DualSPHysics 5.4 Verlet": (1985, 1021)},
}
TARGETS = {10_000: (3.0, 1.7), 100_000: (200, 110)}

CASE = """title = "dam break benchmark"
preset = "improved"
end_time = {end}
[fluid]
dimension = 2
spacing = {l0!r}
sound_speed = inf
tank = [[0.0, 0.0, 0.0], [{length!r}, {height!r}, 0.0]]
water = [[0.0, 0.0, 0.0], [{column!r}, {depth!r}, 0.0]]
[fluid.scheme]
time_step = inf
[structure]
solver = "none"
[coupling.surface]
window = {window!r}
[run]
threads = {threads}
[output]
every = {every!r}
[[output.probe]]
name = "front"
of = "fluid"
at = [0.0, 0.0, 0.0]
quantity = "front"
[[output.probe]]
name = "p_wall"
of = "fluid"
at = [{length!r}, 0.2, 0.0]
quantity = "pressure"
diameter = 0.1
"""

parser = runs.command(__doc__)
parser.add_argument("--particles", type=int, action="append")
parser.add_argument("--threads", type=int, action="append")
parser.add_argument("--units", type=float, default=8.0)
parser.add_argument("--repeats", type=int, default=1)
arguments = parser.parse_args()
unit = math.sqrt(1 / 9.81)  # s


def run(particles, threads):
    high = round(math.sqrt(particles / 2))
    l0 = round(1 / high, 12)
    text = CASE.format(end=repr(arguments.units * unit), l0=l0, length=round(5.366 / l0) * l0, height=round(4 / l0) * l0,
                       column=2 * high * l0, depth=high * l0, window=0.05 * unit, every=0.1 * unit, threads=threads)
    return runs.run(arguments.bin_dir, text, arguments.set).summary


for particles in arguments.particles or [10_000]:
    for threads in arguments.threads or [1, 2]:
        summary = min((run(particles, threads) for _ in range(arguments.repeats)), key=lambda s: s["seconds"]["wall"])
        wall, steps, count = summary["seconds"]["wall"], summary["steps"]["fluid"], summary["particles"]["fluid"]
        stages = summary["seconds"]["fluid"]
        print(f"{count} water particles, {threads} thread{'s' if threads > 1 else ''}: "
              f"{wall / arguments.units:.2f} s per sqrt(H/g)   ({steps / arguments.units:.0f} steps per unit, "
              f"{1e3 * wall / steps:.2f} ms per step, {1e-6 * count * steps / wall:.2f} million particle-steps/s)")
        machine = arguments.bin_dir / "machine_benchmark"
        if machine.exists():
            triad, product = map(float, subprocess.run([str(machine), str(count), str(threads)], check=True,
                                                       capture_output=True, text=True).stdout.split())
            print(f"  a step is worth {1e3 * wall / steps / product:.0f} plain sparse products ({product:.3f} ms each), "
                  f"{1e9 * triad * wall / steps / count / 1e3:.0f} kB per particle of STREAM triad ({triad:.0f} GB/s)")
        for stage, seconds in sorted(stages.items(), key=lambda item: -item[1]):
            print(f"    {stage:<12} {1e3 * seconds / steps:8.3f} ms per step")
        nearest = min(PEERS, key=lambda n: abs(n - particles))
        column = min(threads, 2) - 1
        if abs(nearest - particles) < 0.2 * nearest:
            peers = ", ".join(f"{name} {figures[column]:g}" for name, figures in PEERS[nearest].items())
            print(f"  target {TARGETS[nearest][column]:g} s; elsewhere with as many threads: {peers} s")
        checks = summary["checks"]
        memory = summary["peak_memory_bytes"]["fluid"]
        print(f"  wall pressure peak {summary['probes']['p_wall']['peak'] / 9810:.2f} rho g H, volume drift "
              f"{100 * (checks['volume_drift'] or 0):+.2f} %, voids {checks['voids']:.0f}, lost {checks['lost']:.0f}, "
              f"{memory / count:.0f} bytes per water particle")
