"""Wall time of a window with two solvers that compute nothing: by Strake's own library, and by libprecice.so.3 of Strake.

usage: library_overhead.py BUILD [POINTS ...]
In turns on one machine; of six runs each the least and the median, per window. Wanted: at most 1.15 times the native one.
Needs the targets coupling_idle_native and coupling_idle_precice (-DSTRAKE_BENCHMARKS=ON)."""
import csv
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

BUILD = pathlib.Path(sys.argv[1]).resolve()
POINTS = [int(word) for word in sys.argv[2:]] or [41, 1000, 10000, 100000]
ROUNDS = 6
CASE = """title = "two solvers that compute nothing"
end_time = {windows}
[fluid]
solver = "{program}"
{fluid}
[structure]
solver = "{program}"
{structure}
[coupling.surface]
window = 1.0
[coupling.surface.mapping]
kind = "nearest-neighbour"
[coupling.surface.predictor]
[coupling.surface.converged]
max_iterations = 1
[output]
every = {windows}
"""
CONFIG = """<?xml version="1.0"?>
<precice-configuration>
  <data:vector name="Force" /><data:vector name="Displacement" />
  <mesh name="Water-Mesh" dimensions="2"><use-data name="Force" /><use-data name="Displacement" /></mesh>
  <mesh name="Floor-Mesh" dimensions="2"><use-data name="Force" /><use-data name="Displacement" /></mesh>
  <participant name="Water"><provide-mesh name="Water-Mesh" /><write-data name="Force" mesh="Water-Mesh" /><read-data name="Displacement" mesh="Water-Mesh" /></participant>
  <participant name="Floor"><provide-mesh name="Floor-Mesh" /><receive-mesh name="Water-Mesh" from="Water" /><write-data name="Displacement" mesh="Floor-Mesh" /><read-data name="Force" mesh="Floor-Mesh" />
    <mapping:nearest-neighbor direction="read" from="Water-Mesh" to="Floor-Mesh" constraint="conservative" />
    <mapping:nearest-neighbor direction="write" from="Floor-Mesh" to="Water-Mesh" constraint="consistent" /></participant>
  <m2n:sockets acceptor="Water" connector="Floor" />
  <coupling-scheme:serial-explicit><participants first="Water" second="Floor" /><max-time value="1e9" /><time-window-size value="1" />
    <exchange data="Force" mesh="Water-Mesh" from="Water" to="Floor" /><exchange data="Displacement" mesh="Water-Mesh" from="Floor" to="Water" /></coupling-scheme:serial-explicit>
</precice-configuration>
"""


def once(folder, kind, points):
    subprocess.run([BUILD / "bin" / "strake", "run", f"{kind}.toml", "--force", "--quiet", "--no-trace"], cwd=folder, check=True,
                   env=dict(os.environ, STRAKE_POINTS=str(points), OMP_NUM_THREADS="1"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with open(folder / "runs" / kind / "timing.csv", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    wall = [float(row["wall [s]"]) for row in rows]
    return statistics.mean(wall[len(wall) // 5:])


with tempfile.TemporaryDirectory(prefix="strake-overhead-") as name:
    folder = pathlib.Path(name)
    (folder / "idle.xml").write_text(CONFIG)
    for points in POINTS:
        windows = max(30, min(1000, 2000000 // points))
        for kind in ("native", "precice"):
            sides = {side: f'arguments = ["{who}", "idle.xml"]' if kind == "precice" else "" for side, who in (("fluid", "Water"), ("structure", "Floor"))}
            program = BUILD / "tests" / f"coupling_idle_{kind}"
            (folder / f"{kind}.toml").write_text(CASE.format(windows=windows, program=program, **sides).replace("[coupling.surface.predictor]\n", ""))
        took = {"native": [], "precice": []}
        for _ in range(ROUNDS):
            for kind, times in took.items():
                times.append(once(folder, kind, points))
        least = {kind: min(times) for kind, times in took.items()}
        middle = {kind: statistics.median(times) for kind, times in took.items()}
        print(f"{points:7} points, {windows} windows: native {1e6 * least['native']:.0f} us, libprecice {1e6 * least['precice']:.0f} us a window: "
              f"{least['precice'] / least['native']:.2f} (median {middle['precice'] / middle['native']:.2f})", flush=True)
