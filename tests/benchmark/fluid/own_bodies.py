"""Bodies that nobody tuned: wedges, sections, hulls and STL bodies at default settings, against theory where there is one.

usage: own_bodies.py [BIN_DIR] [--only NAME]… [--coarser 2] [--set KEY=VALUE]… [--keep DIR] [--list]
       (default: build/bin, all bodies, one hour on one core; --coarser 2: twice the spacing, 0.5: half; --keep: case files and runs stay there)
Cases in the plane have the tank, gap and spacing that `strake new wedge` would give; those from STL are what `strake new mesh` writes. Nothing else
is set, but for the step of --set. Contact is when the lowest point meets the level, gap / V. cases/VALIDATION.md, "Bodies that nobody tuned"."""
import math
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import runs

RHO = 1000.0
BOW = [(0, 3), (60, 20), (100, 60), (130, 110), (200, 180), (200, 230)]  # mm, half breadth and height
CASE = """title = "{name}"
end_time = {end}
[fluid]
dimension = 2
spacing = {spacing}
gravity = [0, -9.81]
tank = {tank}
water = {water}
{fluid}
[structure]
{structure}
"""


def tan(degrees):
    return math.tan(math.radians(degrees))


def plane(name, width, spacing, end, structure, top=0.5, fluid="", wide=2.0, deep=1.5):
    """Case text of a body in the plane: a tank four widths wide, one and a half deep."""
    low, high = [-wide * width, -deep * width], [wide * width, top]
    return CASE.format(name=name, end=end, spacing=spacing, tank=[low, high], water=[low, [high[0], 0.0]], fluid=fluid, structure=structure)


def outline(points, speed, more=""):
    return f'solver = "rigid"\nvelocity = [0, {-speed}]\noutline = {[[round(x, 6), round(y, 6)] for x, y in points]}\n{more}'


# --- surfaces for STL -------------------------------------------------------------------------------------------------------------------------
def turned(profile, n=64):
    """Triangles of a body of revolution about y; profile: (radius, height) from the axis below to the axis above."""
    def ring(r, y):
        return [(r * math.cos(2 * math.pi * i / n), y, r * math.sin(2 * math.pi * i / n)) for i in range(n)] if r > 0 else [(0.0, y, 0.0)] * n
    return stacked([ring(r, y) for r, y in profile])


def stacked(rings):
    """Triangles between rings of as many points each; those that coincide in two corners are left out. They point outwards."""
    triangles = []
    for a, b in zip(rings, rings[1:]):
        for i in range(len(a)):
            j = (i + 1) % len(a)
            triangles += [t for t in ((a[i], b[i], b[j]), (a[i], b[j], a[j])) if len(set(t)) == 3]
    volume = sum(p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2]) + p[2] * (q[0] * r[1] - q[1] * r[0]) for p, q, r in triangles)
    return triangles if volume > 0 else [t[::-1] for t in triangles]


def boat():
    """A hull 1 m long and 0.32 m wide: V sections of 20 degrees to the chine, upright sides to the deck at 0.16 m; the bow narrows and rises."""
    rings, n = [], 20
    for i in range(n + 1):
        s = i / n
        fore = max(0.0, (s - 0.5) / 0.5)
        half, keel = 0.16 * (1 - 0.98 * fore**2), 0.10 * fore**3
        chine = max(keel + half * tan(20) * (1 + fore), keel + 0.001)
        x = s - 0.5
        rings.append([(x, keel, 0.0), (x, min(chine, 0.155), half), (x, 0.16, half), (x, 0.16, -half), (x, min(chine, 0.155), -half)])
    ends = [[tuple(sum(p[k] for p in ring) / 5 for k in range(3))] * 5 for ring in (rings[0], rings[-1])]
    return stacked([ends[0]] + rings + [ends[1]])


def planing():
    """A planing hull 0.7 m long and 0.38 m wide: prismatic V of 20 degrees aft, bow that narrows and rises, upright sides; 4 degrees up by the bow. The chine turns by
    70 degrees aft and by 43 at the bow."""
    n, half, trim, rings = 24, 0.19, math.radians(4), []
    for i in range(n + 1):
        s = i / n
        fore = max(0.0, (s - 0.6) / 0.4)
        breadth, keel = half * (1 - 0.9 * fore**2), 0.55 * half * fore**2.5
        x, chine, deck = 0.7 * (s - 0.5), max(half * tan(20), keel + breadth * tan(20) * (1 + 0.8 * fore)), 1.3 * half
        ring = [(x, keel, 0.0), (x, chine, breadth), (x, deck, breadth), (x, deck, -breadth), (x, chine, -breadth)]
        rings.append([(math.cos(trim) * x - math.sin(trim) * y, math.sin(trim) * x + math.cos(trim) * y, z) for x, y, z in ring])
    ends = [[tuple(sum(p[k] for p in ring) / 5 for k in range(3))] * 5 for ring in (rings[0], rings[-1])]
    return stacked([ends[0]] + rings + [ends[1]])


def stl(triangles):
    corner = "".join("facet normal 0 0 0\nouter loop\n" + "".join("vertex %.9g %.9g %.9g\n" % p for p in t) + "endloop\nendfacet\n" for t in triangles)
    return f"solid body\n{corner}endsolid body\n"


# --- what is measured -------------------------------------------------------------------------------------------------------------------------
def impulse(run, begin, end, name="force.y"):
    """Impulse between two instants [N s, per metre in the plane]; the force of a window is its mean."""
    total, before = 0.0, 0.0
    for t, f in zip(run["time"], run[name]):
        total += f * max(0.0, min(t, end) - max(before, begin))
        before = t
    return total


def blow(run):
    """Largest force of a window [kN], its time [ms], and how many times the mean of the 2 ms around it that is."""
    force, time = run["force.y"], run["time"]
    i = max(range(len(force)), key=lambda k: force[k])
    around = [f for f, t in zip(force, time) if abs(t - time[i]) < 1e-3]
    return f"largest force {force[i] / 1e3:.3g} kN at {1e3 * time[i]:.3g} ms, {force[i] * len(around) / max(sum(around), 1e-9):.1f} of the mean of 2 ms around it"


def largest_mean(run, length):
    return max(impulse(run, t - length, t) / length for t in run["time"] if t >= length)


def last(run, *names):
    return ", ".join(f"{name} {run[name][-1]:.4f}" for name in names)


# --- the bodies -------------------------------------------------------------------------------------------------------------------------------
def wedge_10(l0):
    gap, speed = 0.6 * l0, 5.0
    body = f'solver = "rigid"\nvelocity = [0, -5]\n[structure.wedge]\ndeadrise = 10\nwidth = 0.5\napex = [0, {gap}]'

    def read(run):
        return f"impulse 2 to 5 ms after contact {impulse(run, gap / speed + 2e-3, gap / speed + 5e-3):.1f} N s/m (similarity flow 279.6)"
    return plane("wedge", 0.5, l0, 0.0056 + gap / speed, body, 0.42), {}, read


def wedge_slow(l0):
    """Number 23 of seed 20271 of newcomer.py, whose spacing is 12.5 mm."""
    low, high = [-1.25, -0.75], [1.25, 0.375]
    text = CASE.format(name="wedge", end=0.01, spacing=l0, tank=[low, high], water=[low, [high[0], 0.0]], fluid="sound_speed = inf",
                       structure='solver = "rigid"\nvelocity = [0, -2.6]\n[structure.wedge]\ndeadrise = 10\nwidth = 0.5\napex = [0, 0.005]')
    return text, {}, lambda run: f"impulse {impulse(run, 0, 1):.1f} N s/m (similarity flow 122.1)"


def section(l0):
    gap = 0.6 * l0
    side = 0.19
    corners = [(0, gap), (0.16, gap + 0.16 * tan(30)), (0.16, gap + side), (-0.25, gap + side), (-0.25, gap + 0.25 * tan(10))]
    text = plane("section", 0.5, l0, 0.009, outline(corners, 5), 0.42)
    return text, {}, lambda run: f"impulse to 9 ms {impulse(run, 0, 0.009):.1f} N s/m, largest 1-ms mean {largest_mean(run, 1e-3) / 1e3:.1f} kN/m"


def catamaran(l0):
    """Two hulls 0.2 m wide, 0.4 m between their middles, faces of 30 degrees, a deck between them 0.2 m over the keels."""
    gap, rise, top = 0.6 * l0, 0.1 * tan(30), 0.3
    right = [(0.1, gap + 0.2), (0.1, gap + rise), (0.2, gap), (0.3, gap + rise), (0.3, gap + top)]
    corners = [(-x, y) for x, y in right[::-1]] + right
    text = plane("catamaran", 0.6, l0, 0.03, outline(corners, 4, "mass = 120\nfree = { y = true }"), 0.6)
    return text, {}, lambda run: last(run, "body.vy")


def keeled(l0):
    """V of 20 degrees, 0.44 m wide, with a bar of 20 by 20 mm under its keel."""
    gap, bar = 0.6 * l0, 0.02
    right = [(0.01, gap), (0.01, gap + bar), (0.22, gap + bar + 0.21 * tan(20)), (0.22, gap + 0.2)]
    corners = [(x, y) for x, y in right] + [(-x, y) for x, y in right[::-1]]
    text = plane("keel", 0.44, l0, 0.03, outline(corners, 3, "mass = 100\nfree = { x = true, y = true, angle = true }"), 0.5)
    return text, {}, lambda run: last(run, "body.vy", "body.angle")


def heeled(l0):
    gap = 0.6 * l0
    body = (f'solver = "rigid"\nvelocity = [0, -4]\nmass = 60\nfree = {{ x = true, y = true, angle = true }}\n'
            f"[structure.wedge]\ndeadrise = 30\nwidth = 0.5\n[structure.placed]\nangle = 10\nmove = [0, {gap}]")
    return plane("heeled", 0.5, l0, 0.03, body, 0.52), {}, lambda run: last(run, "body.vy", "body.angle")


def bow(l0):
    table = "station [m],height [m],half_breadth [m]\n" + "".join(f"0,{y / 1e3},{x / 1e3}\n" for x, y in BOW)
    body = 'solver = "rigid"\nvelocity = [0, -4]\nmass = 150\nfree = { y = true }\noffsets = "bow.csv"'
    return plane("bow", 0.5, l0, 0.06, body, 0.6), {"bow.csv": table}, lambda run: last(run, "body.vy")


def panels(l0):
    """Two aluminium panels of 5 mm, 15 degrees, 0.4 m wide together, held at the chines; Abaqus file, 40 by 2 cells a panel."""
    gap, n, thick = 0.6 * l0, 40, 0.005
    nodes = [(0.2 * i / n, 0.2 * abs(i) / n * tan(15) + thick / math.cos(math.radians(15)) * j / 2) for i in range(-n, n + 1) for j in range(3)]
    cells = [(3 * i + j, 3 * (i + 1) + j, 3 * (i + 1) + j + 1, 3 * i + j + 1) for i in range(2 * n) for j in range(2)]
    text = "*NODE\n" + "".join(f"{k + 1}, {x:.9g}, {y:.9g}\n" for k, (x, y) in enumerate(nodes)) + "*ELEMENT, TYPE=CPE4, ELSET=panel\n"
    text += "".join(f"{k + 1}, " + ", ".join(str(c + 1) for c in cell) + "\n" for k, cell in enumerate(cells))
    text += f"*NSET, NSET=chines\n1, 2, 3, {len(nodes) - 2}, {len(nodes) - 1}, {len(nodes)}\n"
    body = (f'solver = "fem"\nvelocity = [0, -5]\nmesh = "panels.inp"\n[structure.material]\ndensity = 2700\nyoung = 7e10\npoisson = 0.33\n'
            f'[structure.placed]\nmove = [0, {gap}]\n[[structure.support]]\non = "chines"')

    def read(run):
        return f"impulse to 8.5 ms {impulse(run, 0, 0.0085):.1f} N s/m, mean force 7.5 to 8.5 ms {impulse(run, 0.0075, 0.0085):.1f} kN/m"
    return plane("panels", 0.4, l0, 0.0085, body, 0.424), {"panels.inp": text}, read


def flap(l0):
    """0.4 m long, 40 mm thick, level; it turns down about its left end at 20 rad/s. Its right end meets the level first."""
    gap = 0.6 * l0
    corners = [(-0.2, gap), (0.2, gap), (0.2, gap + 0.04), (-0.2, gap + 0.04)]
    body = outline(corners, 0, f"pivot = [-0.2, {gap}]\nangular_velocity = -20")

    def read(run):
        return "impulse at 1, 1.5, 2 ms " + ", ".join(f"{impulse(run, 0, t):.0f}" for t in (1e-3, 1.5e-3, 2e-3)) + " N s/m (Wagner 47, 149, 204)"
    return plane("flap", 0.4, l0, 0.01, body, 0.5), {}, read


def barge(l0):
    """0.8 m wide, 0.25 m high, 80 kg/m, so 0.1 m deep; let go at 5 degrees in water 1.2 m deep and 3.2 m wide."""
    body = ('solver = "rigid"\nmass = 80\nfree = { x = true, y = true, angle = true }\n'
            "outline = [[-0.4, -0.125], [0.4, -0.125], [0.4, 0.125], [-0.4, 0.125]]\n[structure.placed]\nangle = 5\nmove = [0, 0.025]")
    return plane("barge", 0.8, l0, 1.8, body, 0.5, "submerged = true"), {}, roll


def roll(run):
    """Periods from crossings of the level by the barge, whose angle counts from its start at 5 degrees."""
    t, angle = run["time"], [5 + a for a in run["body.angle"]]
    zero = [t[i] - angle[i] * (t[i + 1] - t[i]) / (angle[i + 1] - angle[i]) for i in range(len(t) - 1) if angle[i] * angle[i + 1] < 0]
    return "periods " + ", ".join(f"{b - a:.3f}" for a, b in zip(zero, zero[2:])) + " s; angle at the end " + f"{angle[-1]:.3f}"


def step_of_water(l0):
    """Water 40 mm higher on the left half of a tank 1 m wide than on the right one, 0.3 m deep in the mean."""
    water = [[0, -0.3], [1, -0.3], [1, -0.02], [0.5, -0.02], [0.5, 0.02], [0, 0.02]]
    probe = f'[[output.probe]]\nname = "level"\nof = "fluid"\nquantity = "level"\nat = [{l0 / 2}, -0.2]\n'
    text = CASE.format(name="step", end=0.8, spacing=l0, tank=[[0, -0.3], [1, 0.2]], water=water, fluid="", structure='solver = "none"\n' + probe)

    def read(run):
        t = run["time"]
        return "level at the wall " + ", ".join(f"{1e3 * (run['level'][min(range(len(t)), key=lambda k: abs(t[k] - at))] - 0.2):.1f} mm at {at} s" for at in (0.3, 0.7))
    return text.replace("\nwater = ", "\nwater_polygon = "), {}, read


def cone_read(run):
    t0 = 0.6 * run.spacing / 5
    force = [impulse(run, t0 + a, t0 + b) * 3 / (RHO * 5**4 * (b**3 - a**3)) for a, b in ((4e-3, 8e-3), (8e-3, 13e-3))]
    return f"F/(rho V^4 t^2) by the impulse from 4 to 8 and from 8 to 13 ms: {force[0]:.1f}, {force[1]:.1f} (theory 23.7)"


def side_read(run):
    t0 = 0.6 * run.spacing / 5
    return "impulse to 2.4, 6.4, 8.8 ms: " + ", ".join(f"{impulse(run, 0, t0 + at):.2f}" for at in (2.4e-3, 6.4e-3, 8.8e-3)) + " N s (8.56, 16.20, 19.39)"


def post_read(run):
    """A flat end meets the water at once: contact is the start of the first window with a hundredth of the largest load."""
    first = next(k for k, f in enumerate(run["force.y"]) if f > 0.01 * max(run["force.y"]))
    t0 = run["time"][first - 1]
    return "impulse at 0.3, 0.6 ms: " + ", ".join(f"{impulse(run, 0, t0 + at) / (RHO * 0.1**3 * 5):.3f}" for at in (3e-4, 6e-4)) + " rho a^3 V (1.607, 1.760)"


def planing_read(run):
    """Scatter of the force about its running mean of a fifteenth of the time, from 0.6 of the time on: the chine is wet."""
    force, half = run["force.y"], max(1, round(len(run["force.y"]) / 30))
    mean = [sum(around) / len(around) for around in (force[max(0, k - half):k + half + 1] for k in range(len(force)))]
    kept = [k for k, t in enumerate(run["time"]) if t > 0.6 * run["time"][-1]]
    square = sum((force[k] - mean[k]) ** 2 for k in kept) / len(kept)
    return f"impulse {impulse(run, 0, 1):.2f} N s, scatter {math.sqrt(square) * len(kept) / sum(mean[k] for k in kept):.3f} of the force"


PLANE = {"wedge": (wedge_10, 0.005), "slow": (wedge_slow, 0.0125), "section": (section, 0.005), "catamaran": (catamaran, 0.005), "keel": (keeled, 0.005),
         "heeled": (heeled, 0.005), "bow": (bow, 0.005), "panels": (panels, 0.008), "barge": (barge, 0.02), "flap": (flap, 0.01), "step": (step_of_water, 0.01)}
SPACE = {"cone": (lambda: turned([(0, 0), (0.2, 0.2 * tan(30)), (0.2, 0.2 * tan(30) + 0.05), (0, 0.2 * tan(30) + 0.05)]), [], cone_read),
         "side": (lambda: [tuple((y, x, z) for x, y, z in t)[::-1] for t in turned([(0, -0.2), (0.1, -0.2), (0.1, 0.2), (0, 0.2)])], [], side_read),
         "post": (lambda: turned([(0, 0), (0.1, 0), (0.1, 0.4), (0, 0.4)]), [], post_read),
         "planing": (planing, [], planing_read),
         "boat": (boat, ["--mass", "20"], lambda run: last(run, "body.vy", "body.angle.z")),
         "boat level": (boat, ["--mass", "20"], lambda run: last(run, "body.vy"))}


def in_space(bin_dir, place, name, factor):
    """Case file of a body from STL, by `strake new mesh`; the boat of that name floats free, its bow 8 degrees up. Returns its path."""
    triangles, options, _ = SPACE[name]
    path, file = place / f"{name.replace(' ', '_')}.toml", place / f"{name.replace(' ', '_')}.stl"
    file.write_text(stl(triangles()))

    def made(more):
        path.unlink(missing_ok=True)
        words = [str(bin_dir / "strake"), "new", "mesh", file.name, "-o", path.name, "--speed", "5", *options, *more]
        subprocess.run(words, cwd=place, check=True, stdout=subprocess.DEVNULL)
        return path.read_text()

    text = made([])
    if factor != 1:
        text = made(["--spacing", f"{factor * spacing_of(text):g}"])
    if name == "boat":
        lift = 0.5 * math.sin(math.radians(8))
        free = "free = { x = true, y = true, z = true, rotation = true }"
        text = text.replace("free = { y = true }", f"{free}\nplaced.angle = 8\nplaced.move = [0, {lift}, 0]")
    path.write_text(text)
    return path


def spacing_of(text):
    return float(next(line for line in text.splitlines() if line.startswith("spacing")).split("=")[1].split("#")[0])


def main():
    parser = runs.command(__doc__, keeps=True)
    parser.add_argument("--only", action="append", metavar="NAME")
    parser.add_argument("--coarser", type=float, default=1.0)
    parser.add_argument("--list", action="store_true", help="names of the bodies")
    arguments = parser.parse_args()
    if arguments.list:
        print("\n".join([*PLANE, *SPACE]))
        return
    bin_dir = arguments.bin_dir.resolve()
    with tempfile.TemporaryDirectory() as temporary:
        place = arguments.keep or pathlib.Path(temporary)
        place.mkdir(parents=True, exist_ok=True)
        for name in arguments.only or [*PLANE, *SPACE]:
            if name in PLANE:
                body, spacing = PLANE[name]
                text, files, read = body(spacing * arguments.coarser)
                path = place / f"{name}.toml"
                path.write_text(text)
                for other, content in files.items():
                    (place / other).write_text(content)
            else:
                path, read = in_space(bin_dir, place, name, arguments.coarser), SPACE[name][2]
            run = runs.run(bin_dir, path.resolve(), ["run.threads=1", *arguments.set])
            run.spacing = spacing_of(path.read_text())
            alarms = [f"ALARM {alarm.get('kind')}" for alarm in run.summary.get("alarms") or []]
            said = [read(run), *([] if name == "step" else [blow(run)]), f"momentum gap {run.summary['checks']['momentum_gap']:.2g}", *alarms]
            print(f"{name}, l0 {1e3 * run.spacing:g} mm: " + "; ".join(said), flush=True)


if __name__ == "__main__":
    main()
