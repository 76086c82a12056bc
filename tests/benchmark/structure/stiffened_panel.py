"""Stiffened panel: solid shells against solids, deflection and first frequencies; writes the mesh of cases/stiffened_panel.toml.

usage: tests/benchmark/structure/stiffened_panel.py [BIN_DIR] [--shells N]… [--solids N]… [--set KEY=VALUE]…
       tests/benchmark/structure/stiffened_panel.py --write FILE.msh [--shells N]      the mesh alone, text of Gmsh 2.2
       (default: build/bin, shells of 1, 2 and 3, solids of 2, 3 and 4)

The panel is 1.2 x 0.9 m, 8 mm thick, with three flat bars of 60 x 6 mm along it, 0.225 m apart. All of its edge is clamped, bars
included. A quarter of it is computed, with faces of symmetry through the middle of the middle bar and across all bars. N: cells from the
skin between two bars, 3 N, over the height of a bar, N, and along half the panel, 8 N. Shells have one cell through skin and bars; solids are
Q2 with two through the skin and the bars from N = 3 on. cases/VALIDATION.md, "Thin panels"."""
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import runs

LENGTH, WIDTH, SKIN = 1.2, 0.9, 0.008         # m
APART, HEIGHT, WEB = 0.225, 0.06, 0.006       # m
# Of a cell, walked around its bottom, then around its top.
CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))


def line(places):
    """Places between those given, with so many equal steps each: [(x, steps), …, (x, 0)]."""
    points = []
    for (a, steps), (b, _) in zip(places, places[1:]):
        points += [a + (b - a) * i / steps for i in range(steps)]
    return points + [places[-1][0]]


def panel(n, through):
    """Text of the mesh of a quarter: x along the bars from the middle, y up from the skin's wet face, z from the middle bar."""
    half = WEB / 2
    xs = line([(0, 8 * n), (LENGTH / 2, 0)])
    ys = line([(0, through), (SKIN, n), (SKIN + HEIGHT, 0)])
    zs = line([(0, max(1, through - 1)), (half, 3 * n), (APART - half, through), (APART + half, 3 * n), (WIDTH / 2, 0)])
    number, nodes, cells = {}, [], []

    def node(at):
        if at not in number:
            number[at] = len(number) + 1
            nodes.append((xs[at[0]], ys[at[1]], zs[at[2]]))
        return number[at]

    faces = {"edge": [], "across": [], "along": [], "wet": []}
    for i in range(len(xs) - 1):
        for j in range(len(ys) - 1):
            for k in range(len(zs) - 1):
                middle = (zs[k] + zs[k + 1]) / 2
                bar = middle < half or abs(middle - APART) < half
                if j >= through and not bar:
                    continue
                cells.append(("bar" if j >= through else "skin", [node((i + a, j + b, k + c)) for a, b, c in CORNERS]))

                def side(axis, upper):
                    four = [(i + a, j + b, k + c) for a, b, c in CORNERS if (a, b, c)[axis] == upper]
                    return [node(at) for at in (four if axis == 2 else [four[m] for m in (0, 1, 3, 2)])]

                faces["edge"] += [side(0, 1)] * (i == len(xs) - 2) + [side(2, 1)] * (k == len(zs) - 2)
                faces["across"] += [side(0, 0)] * (i == 0)
                faces["along"] += [side(2, 0)] * (k == 0)
                faces["wet"] += [side(1, 0)] * (j == 0)
    parts = ["skin", "bar"]
    text = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(parts) + len(faces))]
    text += [f'3 {i + 1} "{name}"' for i, name in enumerate(parts)] + [f'2 {i + 3} "{name}"' for i, name in enumerate(faces)]
    text += ["$EndPhysicalNames", "$Nodes", str(len(nodes))]
    text += [f"{i + 1} {x:.10g} {y:.10g} {z:.10g}" for i, (x, y, z) in enumerate(nodes)] + ["$EndNodes", "$Elements"]
    elements = [(3, i + 3, four) for i, name in enumerate(faces) for four in faces[name]] + [(5, parts.index(p) + 1, c) for p, c in cells]
    text += [str(len(elements))]
    text += [f"{i + 1} {kind} 2 {tag} {tag} {' '.join(map(str, corners))}" for i, (kind, tag, corners) in enumerate(elements)]
    return "\n".join(text + ["$EndElements", ""]), [corners for _, corners in cells]


def unknowns(cells, degree):
    """Three in each node; Q2 has nodes in corners, edges, faces and cells."""
    sets = {(n,) for c in cells for n in c}
    if degree == 2:
        edges = [(a, b) for a in range(8) for b in range(a) if sum(x != y for x, y in zip(CORNERS[a], CORNERS[b])) == 1]
        faces = [tuple(m for m in range(8) if CORNERS[m][axis] == upper) for axis in range(3) for upper in (0, 1)]
        sets |= {tuple(sorted(c[m] for m in part)) for c in cells for part in edges + faces + [tuple(range(8))]}
    return 3 * len(sets)


def main():
    parser = runs.command(__doc__)
    parser.add_argument("--shells", type=int, action="append", metavar="N")
    parser.add_argument("--solids", type=int, action="append", metavar="N")
    parser.add_argument("--write", type=pathlib.Path, metavar="FILE.msh")
    given = parser.parse_args()
    if given.write:
        given.write.write_text(panel((given.shells or [1])[0], 1)[0])
        return
    case = (runs.ROOT / "cases" / "stiffened_panel.toml").read_text()
    table = runs.Table([("cells", 14), ("unknowns", 9), ("middle [mm]", 11), ("bay [mm]", 10), ("f1 [Hz]", 9), ("f2 [Hz]", 9)])
    with tempfile.TemporaryDirectory() as place:
        jobs = [("shells", n) for n in given.shells or [1, 2, 3]] + [("solids", n) for n in given.solids or [2, 3, 4]]
        for kind, n in jobs:
            text, cells = panel(n, 1 if kind == "shells" or n < 3 else 2)
            file = pathlib.Path(place) / f"{kind}_{n}.msh"
            file.write_text(text)
            sets = [f"structure.mesh={file}"] + given.set
            if kind == "solids":
                sets += ["structure.fem.strain=auto", "structure.fem.degree=2"]
            still = runs.run(given.bin_dir, case, sets)
            modal = runs.run(given.bin_dir, case, sets + ["structure.analysis=modal"])
            table.row(f"{kind} {n}", unknowns(cells, 1 if kind == "shells" else 2), f"{1e3 * still.probe('middle.y', 'final'):.5g}", f"{1e3 * still.probe('bay.y', 'final'):.5g}",
                      *(f"{modal.probe(f, 'final'):.5g}" for f in ("f1", "f2")))


main()
