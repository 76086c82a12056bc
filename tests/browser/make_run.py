"""Makes a finished run of N particles of water and a block of hexahedra, as `strake run` would leave it. Usage: make_run.py
FOLDER N [2|3] [FRAMES]. For tests that would take too long to compute: drawing many particles, and space."""
import json
import math
import pathlib
import sys

import h5py
import numpy as np

folder, n = pathlib.Path(sys.argv[1]), int(sys.argv[2])
dimension = int(sys.argv[3]) if len(sys.argv) > 3 else 2
n_frames = int(sys.argv[4]) if len(sys.argv) > 4 else 3
(folder / "frames").mkdir(parents=True, exist_ok=True)
spacing = 1.0 / round(n ** (1.0 / dimension))
side = round(1.0 / spacing)
dt, end = 1e-3, 1e-3 * (n_frames - 1)


def write(name, number, time, position, cells, fields):
    with h5py.File(folder / "frames" / f"{name}-{number:06}.h5", "w") as file:
        file.attrs["format"] = np.bytes_("strake frame 1")
        file.attrs["time"] = time
        file["position"] = position
        file["cells"] = cells
        file.create_group("cell")
        for field, (unit, value) in fields.items():
            data = file.create_dataset(f"point/{field}", data=np.asarray(value, float).reshape(len(position), -1))
            data.attrs["unit"] = np.bytes_(unit)


axes = [np.arange(side) * spacing + 0.5 * spacing] * dimension
lattice = np.stack([a.ravel() for a in np.meshgrid(*axes, indexing="ij")], axis=1)
x = np.zeros((len(lattice), 3))
x[:, :dimension] = lattice
ids = np.arange(len(x))

nodes = [(i, j, k) for k in range(3 if dimension == 3 else 1) for j in range(3) for i in range(11)]
place = {node: at for at, node in enumerate(nodes)}
body = np.array([[0.3 + 0.04 * i, 1.1 + 0.05 * j, 0.4 + 0.1 * k if dimension == 3 else 0] for i, j, k in nodes])
square = [(0, 0), (1, 0), (1, 1), (0, 1)]
if dimension == 3:
    cells = [[place[i + a, j + b, k + c] for c in (0, 1) for a, b in square] for k in range(2) for j in range(2) for i in range(10)]
else:
    cells = [[place[i + a, j + b, 0] for a, b in square] for j in range(2) for i in range(10)]

for frame in range(n_frames):
    t = dt * frame
    wave = 0.05 * np.sin(2 * math.pi * (x[:, 0] - 200 * t))
    moved = x.copy()
    moved[:, 1] += wave * x[:, 1]
    velocity = np.zeros_like(x)
    velocity[:, 1] = wave
    write("fluid", frame, t, moved, ids.reshape(-1, 1), {
        "pressure": ("Pa", 9810 * (1 - x[:, 1]) + 2e4 * wave), "velocity": ("m/s", velocity), "kind": ("1", 0 * ids),
        "surface": ("1", x[:, 1] > 1 - spacing), "id": ("1", ids)})
    bend = np.zeros_like(body)
    bend[:, 1] = 0.02 * math.sin(300 * t + 0.5) * np.sin(math.pi * (body[:, 0] - 0.3) / 0.4)
    write("structure", frame, t, body + bend, np.array(cells),
          {"displacement": ("m", bend), "von_mises": ("Pa", 1e9 * np.abs(bend[:, 1]))})

(folder / "case.toml").write_text(
    f'title = "{n} particles"  # case\nend_time = {end}  # s, case\n\n[fluid]\ndimension = {dimension}  # case\n'
    f'spacing = {spacing}  # m, case\n\n[[output.probe]]\nname = "mid"  # case\n')
(folder / "run.json").write_text(json.dumps({
    "strake": "0.1.0", "host": "", "started": "2025-11-21T02:00:00Z", "ended": "2025-11-21T02:00:10Z", "exit_code": 0,
    "participants": {"fluid": {"solver": "mps"}, "structure": {"solver": "fem"}}}))
rows = "".join(f"{k},{1e-5 * k},{1e-3 * math.sin(0.1 * k)}\n" for k in range(1, 200))
(folder / "history.csv").write_text("window [1],time [s],mid [m]\n" + rows)
