"""A cube from an STL file on still water: the forces and motion of the same cube by its keys, and files that are refused."""
import csv
import pathlib
import struct
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent))
from processes import *  # noqa: F403: the test's own vocabulary

SIDE, LOW = 320.0, 1.0  # mm: eight spacings, so that halved edges give the points of the box; gap to the water
CASE = """title = "cube"
end_time = 1.6e-3
[fluid]
dimension = 3
spacing = 0.04
tank = [[-0.32, -0.24, -0.32], [0.32, 0.6, 0.32]]
water = [[-0.32, -0.24, -0.32], [0.32, 0.0, 0.32]]
[fluid.scheme]
time_step = 2e-4
[structure]
solver = "rigid"
velocity = [0.0, -5.0, 0.0]
material.density = 300
free = { y = true, rotation = true }
"""
REST = """
[coupling.surface]
window = 2e-4
"""
BOX = 'box = [{ name = "cube", min = [-0.16, 0.001, -0.16], max = [0.16, 0.321, 0.16] }]\n'
STL = 'mesh = "cube.stl"\nplaced.scale = 0.001  # the file is in mm\n'


def cube():
    """Triangles with their normals outside [mm]."""
    sides = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    at = [((k & 1) * SIDE - SIDE / 2, (k >> 1 & 1) * SIDE + LOW, (k >> 2) * SIDE - SIDE / 2) for k in range(8)]
    for a, b, c, d in sides:
        yield at[a], at[b], at[c]
        yield at[a], at[c], at[d]


def binary(triangles):
    records = (struct.pack("<12fH", 0, 0, 0, *a, *b, *c, 0) for a, b, c in triangles)
    return bytes(80) + struct.pack("<I", len(triangles)) + b"".join(records)


def history(place, name):
    done = strake("run", f"{name}.toml", "--runs", "runs", cwd=place)
    expect(done.returncode == 0, f"{name}: runs{done.stderr[-500:]}")
    with open(place / "runs" / name / "history.csv", newline="") as file:
        return list(csv.DictReader(file))


def column(rows, name):
    return [float(row[name] or 0) for row in rows]


with folder() as temporary:
    place = pathlib.Path(temporary)
    triangles = list(cube())
    (place / "cube.stl").write_bytes(binary(triangles))
    (place / "box.toml").write_text(CASE + BOX + REST)
    (place / "stl.toml").write_text(CASE + STL + REST)

    checked = strake("check", "stl.toml", cwd=place)
    expect(checked.returncode == 0 and "STL file   12 triangles   8 points" in checked.stdout, "check tells what the file holds")
    expect("386 interface points" in checked.stdout and "mass 9.8304 kg" in checked.stdout, "check tells points and mass")

    box, stl = history(place, "box"), history(place, "stl")
    for name in ("body.fy [N]", "body.vy [m/s]", "body.y [m]"):
        one, other = column(box, name), column(stl, name)
        largest, apart = max(map(abs, one)), max(abs(a - b) for a, b in zip(one, other))
        # Measured: 1e-13. Round-off of the float32 places alone is 6e-8.
        expect(len(one) == len(other) == 8 and largest > 0 and apart < 1e-7 * largest,
               f"{name}: {apart:.2g} apart of {largest:.4g}")
    expect(max(map(abs, column(stl, "body.fy [N]"))) > 1e4, "the cube meets the water")

    def refused(words, expected):
        done = strake("check", "stl.toml", *words, cwd=place)
        expect(done.returncode == 3 and expected in done.stderr + done.stdout and "fix:" in done.stderr + done.stdout,
               f"refused: {expected}" + ("" if expected in done.stderr + done.stdout else done.stderr + done.stdout))

    refused(["--set", "structure.solver=particle"], "an STL file holds a surface alone, and a particle structure deforms")
    refused(["--set", "structure.loaded_faces=bottom"], "have faces with names")
    refused(["--set", "structure.placed.scale=1"], "structure.placed.scale = 0.001, if the file is in mm")
    refused(["--set", "structure.placed.move=[0.5, 0, 0]", "--set", "fluid.spacing=0.002"],  # too large to be built by a check
            "a body inside the tank: it reaches from (0.34, 0.001, -0.16) to (0.66, 0.321, 0.16) m")
    (place / "cube.stl").write_bytes(binary(triangles[:-1]))
    refused([], "cube.stl: the surface is not closed, edges with one triangle alone: 3; the first from (160, 1, -160) to (160, 1, 160), triangle 5")
    (place / "cube.stl").write_bytes(binary(triangles)[:-10])
    refused([], "cube.stl: a binary STL file of 12 triangles has 684 bytes, this one has 674: it is cut off")
    (place / "cube.obj").write_text("")
    refused(["--set", "structure.mesh=cube.obj"], "a file that ends in .msh (Gmsh) or .inp (Abaqus), or in .stl")
finish()
