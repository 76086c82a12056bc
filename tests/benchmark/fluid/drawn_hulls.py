"""Hulls in space whose shape is drawn by chance, at default settings: at rest in still water beside the weight of the water that they displace, or driven into it.

usage: drawn_hulls.py [BIN_DIR] [--count 6] [--seed 1] [--enter] [--spacing 0.025] [--set KEY=VALUE]…
       (default: build/bin; a run takes a minute on one core)
Sections are V, round or of a power law, with a transom or without, a forefoot that rises, trim and heel. At rest the force after 0.03 s is printed in parts of the weight: its
range, mean and rms about the mean, and the range of the force to the side. Of a hull that enters: the rms of the force about its running mean, in parts of the time.
cases/VALIDATION.md, "Hulls at rest"."""
import math
import pathlib
import random
import statistics
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import runs

STATIONS, WATERLINES, FREEBOARD, DEPTH = 20, 8, 0.12, 0.08  # DEPTH: how far a hull that enters goes [m]
CASE = """title = "drawn hull"
end_time = {end:.4f}
[fluid]
dimension = 3
spacing = {spacing}
gravity = [0, -9.81, 0]
{at_rest}
tank = [[-0.6, -0.375, -0.4], [0.6, 0.3, 0.4]]
water = [[-0.6, -0.375, -0.4], [0.6, 0, 0.4]]
[structure]
solver = "rigid"
mesh = "{mesh}"
{velocity}
"""


class Hull:
    """A hull, its keel lowest at y = -draught; x ahead, y up [m]."""

    def __init__(self, chance):
        self.length, self.breadth, self.draught = chance.uniform(0.5, 0.8), chance.uniform(0.18, 0.3), chance.uniform(0.08, 0.14)
        self.transom, self.fullness = chance.choice([0, 0.6, 1.0]), chance.uniform(1.5, 3)
        self.kind, self.power, self.rise = chance.choice(["power", "v", "round"]), chance.uniform(0.35, 1.0), chance.uniform(0, 0.6)
        self.trim, self.heel = (math.radians(chance.choice([0, chance.uniform(-most, most)])) for most in (6, 15))
        self.speed = chance.uniform(2, 5)

    def __str__(self):
        return (f"{self.kind:5} L {self.length:.2f} B {self.breadth:.2f} D {self.draught:.2f} transom {self.transom} "
                f"trim {math.degrees(self.trim):+.1f} heel {math.degrees(self.heel):+.1f}")

    def half_breadth(self, x):
        u = 2 * x / self.length
        if u >= 0:
            return 0.5 * self.breadth * max(0, 1 - u**self.fullness)
        return 0.5 * self.breadth * (self.transom + (1 - self.transom) * (1 - abs(u) ** self.fullness))

    def section(self, x):
        """Points of the starboard half, from the keel to the deck."""
        keel, half = -self.draught * (1 - self.rise * max(0, 2 * x / self.length) ** 3), self.half_breadth(x)
        half = half if half > 1e-9 else 0.0
        shape = {"v": lambda s: s, "round": lambda s: math.sqrt(1 - (1 - s) ** 2), "power": lambda s: s**self.power}[self.kind]
        below = [(x, keel * (1 - j / WATERLINES), half * shape(j / WATERLINES)) for j in range(WATERLINES + 1)]
        return below + [(x, 0.5 * FREEBOARD, half), (x, FREEBOARD, half)]

    def triangles(self):
        """Its surface, seen counter-clockwise from outside, turned by trim and heel."""
        rows = [self.section(self.length * (i / STATIONS - 0.5)) for i in range(STATIONS + 1)]
        found = []

        def add(*corners):
            if len({tuple(round(v, 9) for v in c) for c in corners}) == 3:
                found.append(tuple(self.turned(c) for c in corners))

        def port(c):
            return c[0], c[1], -c[2]

        for i, (a, b) in enumerate(zip(rows, rows[1:])):
            fore = 2 * i >= STATIONS  # diagonals that leave no triangle in the plane of symmetry
            for low, high in zip(range(len(a)), range(1, len(a))):
                p, q, r, s = a[low], b[low], b[high], a[high]
                for t in [(p, q, s), (q, r, s)] if fore else [(p, q, r), (p, r, s)]:
                    add(*t)
                    add(port(t[0]), port(t[2]), port(t[1]))
            p, q = a[-1], b[-1]
            for t in [(p, q, port(p)), (q, port(q), port(p))] if fore else [(p, q, port(q)), (p, port(q), port(p))]:
                add(*t)
        if self.transom:
            for low, high in zip(rows[0], rows[0][1:]):
                add(low, high, port(high))
                add(low, port(high), port(low))
        return found

    def turned(self, c):
        y, z = math.cos(self.heel) * c[1] - math.sin(self.heel) * c[2], math.sin(self.heel) * c[1] + math.cos(self.heel) * c[2]
        return math.cos(self.trim) * c[0] - math.sin(self.trim) * y + 0.003, math.sin(self.trim) * c[0] + math.cos(self.trim) * y, z + 0.002


def displaced(triangles):
    """Volume of the body below y = 0 [m^3]: the integral of y n_y over what of its surface lies there."""
    volume = 0.0
    for triangle in triangles:
        below = []
        for a, b in zip(triangle, triangle[1:] + triangle[:1]):
            if a[1] <= 0:
                below.append(a)
            if (a[1] <= 0) != (b[1] <= 0):
                s = -a[1] / (b[1] - a[1])
                below.append(tuple(u + s * (v - u) for u, v in zip(a, b)))
        for q, r in zip(below[1:], below[2:]):
            p = below[0]
            area = 0.5 * ((q[2] - p[2]) * (r[0] - p[0]) - (q[0] - p[0]) * (r[2] - p[2]))
            volume += area * (p[1] + q[1] + r[1]) / 3
    return volume


def write_stl(path, triangles, lift):
    with path.open("w") as file:
        file.write("solid hull\n")
        for triangle in triangles:
            file.write("facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {x:.9g} {y + lift:.9g} {z:.9g}\n" for x, y, z in triangle) + "endloop\nendfacet\n")
        file.write("endsolid hull\n")


def at_rest(run, weight):
    kept = [k for k, t in enumerate(run["time"]) if t > 0.03]
    force, side = ([run[name][k] / weight for k in kept] for name in ("force.y", "force.z"))
    return (f"weight {weight:.1f} N: force {min(force):.3f} to {max(force):.3f} of it, mean {statistics.mean(force):.3f}, rms {statistics.pstdev(force):.4f}, "
            f"to the side {min(side):.3f} to {max(side):.3f}, fastest water {max(run['water.largest_speed']):.2f} m/s")


def entering(run):
    force, end = run["force.y"], run["time"][-1]
    half = max(1, round(len(force) / 30))
    mean = [statistics.mean(force[max(0, k - half):k + half + 1]) for k in range(len(force))]
    scatter = []
    for low, high in ((0.15, 0.3), (0.3, 0.5), (0.5, 0.7), (0.7, 0.95)):
        kept = [k for k, t in enumerate(run["time"]) if low * end <= t < high * end]
        scatter.append(statistics.pstdev([force[k] - mean[k] for k in kept]) / statistics.mean([mean[k] for k in kept]))
    return f"scatter {', '.join(f'{s:.2f}' for s in scatter)} of the force, fastest water {max(run['water.largest_speed']):.2f} m/s"


def main():
    parser = runs.command(__doc__)
    parser.add_argument("--count", type=int, default=6)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--enter", action="store_true", help="driven into the water")
    parser.add_argument("--spacing", type=float, default=0.025)
    arguments = parser.parse_args()
    chance = random.Random(arguments.seed)
    for _ in range(arguments.count):
        hull = Hull(chance)
        triangles = hull.triangles()
        lift = 0.6 * arguments.spacing - min(c[1] for t in triangles for c in t) if arguments.enter else 0.0
        with tempfile.TemporaryDirectory() as folder:
            mesh = pathlib.Path(folder) / "hull.stl"
            write_stl(mesh, triangles, lift)
            text = CASE.format(end=DEPTH / hull.speed if arguments.enter else 0.15, spacing=arguments.spacing, mesh=mesh,
                               at_rest="" if arguments.enter else "submerged = true", velocity=f"velocity = [0, -{hull.speed:.3f}, 0]" if arguments.enter else "")
            run = runs.run(arguments.bin_dir, text, ["run.threads=1", *arguments.set])
        print(f"{hull}: {entering(run) if arguments.enter else at_rest(run, 9810 * displaced(triangles))}", flush=True)


if __name__ == "__main__":
    main()
