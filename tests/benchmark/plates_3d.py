"""Square plate and disc that meet water in space, rigid, c = inf: impulse of contact and after it, against potential flow.

usage: tests/benchmark/plates_3d.py [BIN_DIR] [--theory] [--shape square|disc]… [--cells N]… [--at-once N] [--set KEY=VALUE]… [--keep DIR]
       (default: build/bin, both shapes, 5 and 10 spacings per half width, two runs at a time; --theory: no runs; needs numpy)
The half width or radius is a = 0.1 m, V = 5 m/s, the basin 6 a square and 3 a deep; steps of 1e-4 and 1e-5 s, from a gap of 0.1 l0.
t_c is the start of the first step with a load. The impulse is that of the force on the whole body. With steps of 1e-4 s the flow
round the edges begins 100 us late, and the impulse after 300 us is not judged. cases/VALIDATION.md, "Plates in space".

Theory: the level surface has p = 0 beside the plate, the walls are rigid. With waves k = 2 pi (m, n)/W of a basin W wide and H deep
the velocity V under the plate needs the impulse q of pressure, q = sum Q_j f_j, with
    A Q = rho V <f, 1>,   A_ij = (1/W^2) sum over all (m, n) of |k| tanh(|k| H) F_i(k) F_j(k),   F_j = <f_j, cos k_x x cos k_z z>.
  square  f = sqrt(1 - x^2) U_2i(x) sqrt(1 - z^2) U_2j(z), lengths in a, Chebyshev's U
  disc    f = integral from r to 1 of P_2j+1(t)/sqrt(t^2 - r^2) dt, Legendre's P, hence F = (2 pi/k) int_0^1 P_2j+1(t) sin(k t) dt
Waves left out add to A as one over the highest of them, so A is carried on from two sums. Beside an edge
the impulse is rho B sqrt(s), s the distance. The water that flows round the edge acts as an edge further out by 1.118 (B V t)^(2/3)
(plate_edge.py). So after contact the impulse grows by (pi/4) rho (integral of B^2 1.118 (B V t)^(2/3) along the edge), to first
order in (V t/a)^(2/3)."""
import math
import pathlib
import tempfile

try:
    import numpy
except ImportError:
    raise SystemExit("plates_3d.py: needs numpy\n  fix: install the package python3-numpy, and call the system's python3") from None

import runs

DENSITY, HALF, SPEED = 1000.0, 0.1, 5.0  # kg/m^3, m, m/s
WIDTH, DEPTH = 6.0, 3.0                  # of the basin [a]
EDGE = 1.118                             # 2 C of plate_edge.py


def square(width, depth, highest, count):
    """Impulse [rho a^3 V], that of the middle [rho a V], and growth after contact [of the impulse, per (V t/a)^(2/3)]."""
    k = 2 * math.pi / width * numpy.arange(int(highest * width / (2 * math.pi)) + 1)
    weight, odd = numpy.where(k > 0, 2.0, 1.0) / width, 2 * numpy.arange(count) + 1
    angle, ring = middles(int(highest) + 2 * count + 60), middles(4000)
    terms = numpy.cos(numpy.outer(k, numpy.cos(angle))) @ (numpy.sin(angle)[:, None] * numpy.sin(odd * angle[:, None])) * math.pi / len(angle)

    def matrix(n):
        size = numpy.hypot(k[:n, None], k[None, :n])
        pairs = numpy.einsum("xi,xj->ijx", terms[:n], terms[:n]).reshape(count**2, n)
        whole = pairs @ (size * numpy.tanh(size * depth) * numpy.outer(weight[:n], weight[:n])) @ pairs.T
        return whole.reshape(4 * (count,)).transpose(0, 2, 1, 3).reshape(count**2, count**2)

    uniform, sign = numpy.outer(terms[0], terms[0]).ravel(), (-1.0) ** numpy.arange(count)
    q = numpy.linalg.solve(2 * matrix(len(k)) - matrix((len(k) + 1) // 2), uniform)
    impulse, q = q @ uniform, q.reshape(count, count)
    edge = math.sqrt(2) * (odd @ q) @ numpy.sin(odd[:, None] * ring)  # B
    growth = math.pi / 4 * EDGE * 4 * (numpy.abs(edge) ** (8 / 3) * numpy.sin(ring)).sum() * math.pi / len(ring)
    return impulse, sign @ q @ sign, growth / impulse


def disc(width, depth, highest, count):
    """The same of the disc. What the corners of the basin do to the round flow is left out."""
    step = numpy.arange(int(highest * width / (2 * math.pi)) + 1) * 2 * math.pi / width
    weight = numpy.where(step > 0, 2.0, 1.0) / width
    size, weight = numpy.hypot(step[:, None], step[None, :]).ravel(), numpy.outer(weight, weight).ravel()
    place, share = numpy.polynomial.legendre.leggauss(int(highest / 2) + 40)
    place, share = (place + 1) / 2, share / 2
    shapes = numpy.array([numpy.polynomial.legendre.Legendre.basis(2 * j + 1)(place) * share for j in range(count)])
    known = numpy.linspace(0, highest, int(60 * highest) + 2)
    terms = numpy.concatenate([2 * math.pi * shapes @ (place[:, None] * numpy.sinc(numpy.outer(place, part) / math.pi))
                               for part in numpy.array_split(known, 50)], axis=1)

    def matrix(limit):
        kept = size <= limit
        f = numpy.array([numpy.interp(size[kept], known, row) for row in terms])
        return (f * size[kept] * numpy.tanh(size[kept] * depth) * weight[kept]) @ f.T

    q = numpy.linalg.solve(2 * matrix(highest) - matrix(highest / 2), terms[:, 0])
    impulse, edge = q @ terms[:, 0], math.sqrt(2) * q.sum()
    return impulse, q @ (shapes @ (1 / place)), math.pi / 4 * EDGE * 2 * math.pi * edge ** (8 / 3) / impulse


def middles(count):
    """Angles of the midpoint rule over half a turn."""
    return (numpy.arange(count) + 0.5) * math.pi / count


def disc_mesh(path, low, thickness, size):
    """Writes a disc of prisms and hexahedra about `size` [m] large, in the format of Gmsh."""
    rings, layers = round(HALF / size), max(1, round(thickness / size))
    sectors = round(2 * math.pi * HALF / size)
    nodes, cells = [], []
    for layer in range(layers + 1):
        y = low + thickness * layer / layers
        nodes.append((0.0, y, 0.0))
        nodes += [(HALF * ring / rings * math.cos(turn), y, -HALF * ring / rings * math.sin(turn)) for ring in range(1, rings + 1)
                  for turn in (2 * math.pi * sector / sectors for sector in range(sectors))]
    per = 1 + rings * sectors
    for layer in range(layers):
        for sector in range(sectors):
            after = (sector + 1) % sectors
            for ring in range(rings):
                inner, outer = (1 + (ring - 1) * sectors, 1 + ring * sectors)
                face = ([0, outer + sector, outer + after] if ring == 0 else
                        [inner + sector, outer + sector, outer + after, inner + after])
                cells.append([1 + n + per * z for z in (layer, layer + 1) for n in face])
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(nodes))]
    lines += [f"{number} {x!r} {y!r} {z!r}" for number, (x, y, z) in enumerate(nodes, 1)]
    lines += ["$EndNodes", "$Elements", str(len(cells))]
    lines += [f"{number} {6 if len(cell) == 6 else 5} 2 0 1 {' '.join(map(str, cell))}" for number, cell in enumerate(cells, 1)]
    path.write_text("\n".join([*lines, "$EndElements", ""]))


def case(shape, cells, step, folder):
    """A run from a gap of 0.1 l0 to 330 us past the longest way to the water."""
    l0 = HALF / cells
    gap, top = 0.1 * l0, 8 * l0
    end = math.ceil((gap / SPEED + 3.3e-4) / step) * step
    if shape == "disc":
        mesh = folder / f"disc-{cells}.msh"
        disc_mesh(mesh, gap, 4 * l0, l0)
        body = f'mesh = "{mesh}"'
    else:
        body = f"depth = {2 * HALF}\nplate = {{ length = {2 * HALF}, thickness = {4 * l0!r}, bottom = [0, {gap!r}, 0] }}"
    low, high = f"[{-3 * HALF}, {-3 * HALF}, {-3 * HALF}]", 3 * HALF
    return f"""
end_time = {end!r}
[fluid]
dimension = 3
spacing = {l0!r}
sound_speed = inf
gravity = [0, 0, 0]
tank = [{low}, [{high}, {top!r}, {high}]]
water = [{low}, [{high}, 0, {high}]]
scheme.time_step = {step!r}
[structure]
solver = "rigid"
velocity = [0, {-SPEED}, 0]
mass = 1.0
{body}
[coupling.surface]
window = {step!r}
[output]
every = {end!r}
"""


def main():
    parser = runs.command(__doc__, keeps=True)
    parser.add_argument("--theory", action="store_true")
    parser.add_argument("--shape", action="append", choices=("square", "disc"))
    parser.add_argument("--cells", type=int, action="append", metavar="N")
    parser.add_argument("--at-once", type=int, default=2, metavar="N")
    arguments = parser.parse_args()
    shapes = arguments.shape or ["square", "disc"]
    print("Theory: impulse in rho a^3 V, of the middle in rho a V, growth of the impulse per (V t/a)^(2/3)")
    table = runs.Table([("shape", 6), ("basin [a]", 9), ("highest wave [1/a]", 18), ("shapes", 6), ("impulse", 8), ("middle", 7), ("growth", 6)])
    theory = {}
    for shape in shapes:
        solve = square if shape == "square" else disc
        for width, depth, highest, count in ((WIDTH, DEPTH, 100, 2), (WIDTH, DEPTH, 200, 3), (WIDTH, DEPTH, 400, 4), (16.0, 8.0, 200, 4)):
            found = solve(width, depth, highest, count)
            table.row(shape, f"{width:g} x {depth:g}", f"{highest:g}", count, *(f"{value:.4f}" for value in found))
            theory[shape] = found if width == WIDTH else theory[shape]
    if arguments.theory:
        return
    print("\nRuns: impulse over that of potential flow")
    table = runs.Table([("shape", 6), ("cells", 5), ("step [s]", 8), ("contact", 8), ("gate", 5), ("after 300 us", 12), ("gate", 5), ("met", 4),
                        ("momentum gap", 12), ("wall [s]", 8)])
    with tempfile.TemporaryDirectory() as place:
        keys = [(shape, cells, step) for shape in shapes for cells in arguments.cells or [5, 10] for step in (1e-4, 1e-5)]
        jobs = [(case(*key, pathlib.Path(place)), ["run.threads=1", *arguments.set]) for key in keys]
        for (shape, cells, step), run in zip(keys, runs.run_all(arguments.bin_dir, jobs, arguments.at_once)):
            impulse, _, growth = theory[shape]
            scale, after = DENSITY * HALF**3 * SPEED * impulse, 3e-4
            loads = run["force.y"]
            met = next(number for number, load in enumerate(loads) if load * step > 0.01 * scale)
            last = met + round(after / step)
            at_once, later = step * loads[met] / scale, step * sum(loads[met:last]) / scale / (1 + growth * (SPEED * after / HALF) ** (2 / 3))
            judged, gate = cells >= 10, 0.05
            wrong = judged and (abs(at_once - 1) > gate or (step < 5e-5 and abs(later - 1) > gate))
            table.row(shape, cells, f"{step:g}", runs.off(at_once, 1), "5 %" if judged else "", runs.off(later, 1),
                      "5 %" if judged and step < 5e-5 else "", ("NO" if wrong else "yes") if judged else "",
                      f"{run.summary['checks']['momentum_gap']:.1e}", f"{run.summary['seconds']['wall']:.0f}")
    table.keep(arguments.keep, "plates-3d.csv")


if __name__ == "__main__":
    main()
