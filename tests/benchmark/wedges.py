"""Wedges at constant speed into still water without gravity, beside the similarity solution of each deadrise.

usage: tests/benchmark/wedges.py [BIN_DIR] [--deadrise DEG]… [--across N] [--step S] [--threads N] [--set KEY=VALUE]… [--keep DIR]
       (default: build/bin, 10 20 30 40 60 degrees, 100 spacings per half wetted width, steps of 0.06 l0/V)
Prints for each angle, over the last 20 % of growth:
  K        slope of F against t over rho V^3 (least squares), the figure of merit of VALIDATION C4
  F/t      mean of F/(rho V^3 t), t from the moment the apex meets the still level
  Cp       largest mean of p/(rho V^2/2) over bins of z/(V t), without 3 l0 at the apex, and its place
  sides    difference of the mean force on the two faces' horizontal parts over the vertical force
  gap      |momentum of water - impulses| over the vertical impulse on the body
and writes the distribution of pressure beside --keep DIR/wedge-DEG.csv: z/Vt [1], Cp [1].
Reference: theory, exact similarity flow (VALIDATION C4: Dobrovol'skaya's problem solved by collocation), for water without
bounds; the tank is twelve half wetted widths long each side of the wedge and ten deep: half of that adds 4 % to the force at 40 degrees."""
import argparse
import csv
import json
import math
import pathlib
import subprocess
import tempfile

# deadrise [deg]: K = F/(rho V^3 t), largest Cp, its z/(V t); 60 degrees: at the apex
EXACT = {4: (1490.1, 501.4, 0.567), 7.5: (397.78, 140.3, 0.561), 10: (213.02, 77.7, 0.554), 15: (84.964, 33.18, 0.535),
         20: (42.287, 17.74, 0.508), 30: (14.024, 6.896, 0.426), 40: (5.4478, 3.253, 0.290), 45: (3.4484, 2.706, -1.0),
         60: (0.80459, 1.804, -1.0), 70: (0.24229, 1.44, -1.0)}
SPEED, DENSITY, HALF = 10.0, 1000.0, 1.0  # m/s, kg/m^3, half wetted width at the end [m]
PROBES = 60

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("bin_dir", nargs="?", type=pathlib.Path)
parser.add_argument("--deadrise", type=float, action="append")
parser.add_argument("--across", type=int, default=100)
parser.add_argument("--step", type=float, default=0.06)
parser.add_argument("--threads", type=int, default=2)
parser.add_argument("--set", action="append", default=[])
parser.add_argument("--keep", type=pathlib.Path)
arguments = parser.parse_args()
bin_dir = arguments.bin_dir or pathlib.Path(__file__).resolve().parents[2] / "build" / "bin"


def case(deadrise, l0):
    slope = math.tan(math.radians(deadrise))
    reach = 1 + max(0.0, EXACT[deadrise][2])  # of the largest pressure over the apex, in V t
    depth = HALF * slope / reach              # V t at the end
    gap = 0.5 * l0
    width = 2 * HALF * 1.5
    tank, floor = round(12 * HALF / l0) * l0, round(10 * HALF / l0) * l0
    rim = round((0.5 * width * slope + gap + 1.0) / l0) * l0
    step = arguments.step * l0 / SPEED
    end = round((depth + gap) / SPEED / step) * step  # a short last step would show what the others leave, over its own length
    text = f"""title = "wedge benchmark"
preset = "improved"
end_time = {end!r}
[fluid]
dimension = 2
spacing = {l0!r}
density = {DENSITY}
kinematic_viscosity = 0.0
sound_speed = inf
gravity = [0.0, 0.0, 0.0]
tank = [[{-tank!r}, {-floor!r}, 0.0], [{tank!r}, {rim!r}, 0.0]]
water = [[{-tank!r}, {-floor!r}, 0.0], [{tank!r}, 0.0, 0.0]]
[fluid.scheme]
time_step = {step!r}
[structure]
solver = "rigid"
velocity = [0.0, {-SPEED}, 0.0]
[structure.wedge]
deadrise = {deadrise}
width = {width!r}
apex = [0.0, {gap!r}, 0.0]
[coupling.surface]
window = {step!r}
[run]
threads = {arguments.threads}
[output]
every = {end!r}
"""
    for k in range(PROBES):
        x = 1.2 * HALF * (k + 0.5) / PROBES
        text += f"""[[output.probe]]
name = "p{k:02d}"
of = "fluid"
at = [{x!r}, {gap + x * slope!r}, 0.0]
quantity = "pressure"
diameter = {2 * l0!r}
"""
    return text, gap, end, depth, slope


def fit_slope(times, values):
    n, mt, mv = len(times), sum(times) / len(times), sum(values) / len(values)
    return sum((t - mt) * (v - mv) for t, v in zip(times, values)) / sum((t - mt) ** 2 for t in times)


print(f"{'deadrise':>8} {'K':>8} {'exact':>8} {'':>8} {'F/t':>8} {'':>8} {'rms':>6} {'Cp':>7} {'exact':>7} {'z/Vt':>6} {'exact':>6} "
      f"{'sides':>7} {'gap':>7} {'particles':>9} {'wall':>8}")
for deadrise in arguments.deadrise or [10.0, 20.0, 30.0, 40.0, 60.0]:
    exact, cp_exact, z_exact = EXACT[deadrise]
    l0 = HALF / arguments.across
    text, gap, end, depth, slope = case(deadrise, l0)
    with tempfile.TemporaryDirectory() as place:
        path = pathlib.Path(place) / "wedge_benchmark.toml"
        path.write_text(text)
        words = [str(bin_dir / "strake"), "run", str(path), "--quiet"]
        for pair in arguments.set:
            words += ["--set", pair]
        subprocess.run(words, cwd=place, check=True, stdout=subprocess.DEVNULL)
        run = pathlib.Path(place) / "runs" / path.stem
        summary = json.loads((run / "summary.json").read_text())
        rows = list(csv.DictReader((run / "history.csv").open()))
    met = gap / SPEED
    growth = end - met
    rows = [r for r in rows if float(r["time [s]"]) > met + 0.8 * growth]
    times = [float(r["time [s]"]) - met for r in rows]
    unit = DENSITY * SPEED**3
    force = [float(r["force.y [N/m]"]) / unit for r in rows]
    side = sum(float(r["force.x [N/m]"]) for r in rows) / sum(float(r["force.y [N/m]"]) for r in rows)
    mean = sum(f / t for f, t in zip(force, times)) / len(rows)
    rms = math.sqrt(sum((f / t - mean) ** 2 for f, t in zip(force, times)) / len(rows))
    bins = {}
    for row, t in zip(rows, times):
        for k in range(PROBES):
            height = 1.2 * HALF * (k + 0.5) / PROBES * slope  # over the apex
            if height < 3 * l0 * math.sin(math.radians(deadrise)):
                continue
            bins.setdefault(round((height / (SPEED * t) - 1) / 0.02), []).append(
                float(row[f"p{k:02d}.mean [Pa]"]) / (0.5 * DENSITY * SPEED**2))
    curve = sorted((0.02 * b, sum(v) / len(v)) for b, v in bins.items() if len(v) >= 10)
    z_at, cp = max(curve, key=lambda point: point[1])
    if arguments.keep:
        arguments.keep.mkdir(parents=True, exist_ok=True)
        with (arguments.keep / f"wedge-{deadrise:g}.csv").open("w") as file:
            file.write("z/Vt [1],Cp [1]\n" + "".join(f"{z:.3f},{c:.4g}\n" for z, c in curve))
    k = fit_slope(times, force)
    gap_of = summary["checks"].get("momentum_gap")
    print(f"{deadrise:8g} {k:8.2f} {exact:8.2f} {100 * (k / exact - 1):+7.1f}% {mean:8.2f} {100 * (mean / exact - 1):+7.1f}% "
          f"{rms / mean:6.2f} {cp:7.2f} {cp_exact:7.2f} {z_at:6.2f} {z_exact:6.2f} {side:7.3f} {gap_of:7.4f} "
          f"{summary['particles']['fluid']:9d} {summary['seconds']['wall']:6.0f} s", flush=True)
