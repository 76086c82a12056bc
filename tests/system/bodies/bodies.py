"""Several bodies in one water: two plates beside each other against one alone, two floors of different solvers, names in
every file, resume, replay, and bodies that are refused."""
import json
import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent))
from processes import *  # noqa: F403: the test's own vocabulary

FLOORS = ROOT / "cases" / "two_floors" / "two_floors.toml"
WATER = """title = "plates"
end_time = {end}
[fluid]
dimension = 2
spacing = 0.02
tank = [[{left}, -0.3], [{right}, 0.3]]
water = [[{left}, -0.3], [{right}, 0.0]]
sound_speed = inf
[fluid.scheme]
time_step = 2e-4
[coupling.surface]
window = 2e-4
[output]
every = 1e-3
default_probes = false
"""
PLATE = """solver = "rigid"
velocity = [0.0, -1.0, 0.0]
[{table}.plate]
length = 0.2
thickness = 0.04
bottom = [{x}, 0.012, 0.0]
"""


def plates(end, left, right, *places):
    if len(places) == 1:
        return WATER.format(end=end, left=left, right=right) + "[structure]\n" + PLATE.format(table="structure", x=places[0])
    names = ("left", "right")
    return WATER.format(end=end, left=left, right=right) + "".join(
        f'[[structures]]\nname = "{name}"\n' + PLATE.format(table="structures", x=x) for name, x in zip(names, places))


def mean(values):
    return sum(values) / len(values)


with folder() as name:
    place = pathlib.Path(name)
    runs = place / "runs"
    # Two plates in a basin that is symmetric about x = 0: a wall in the plane of symmetry changes nothing.
    (place / "two.toml").write_text(plates(0.02, -1, 1, -0.5, 0.5))
    (place / "one.toml").write_text(plates(0.02, -1, 0, -0.5))
    said = run_case(place, "two.toml").stdout
    expect("fluid.xdmf  left.xdmf  right.xdmf" in said, "the console names the fields of every body")
    run_case(place, "one.toml")
    two, one = columns(runs / "two"), columns(runs / "one")
    alone = mean(one["force.y [N/m]"])
    for body in ("left", "right"):
        beside = mean(two[f"{body}.force.y [N/m]"])
        expect(abs(beside / alone - 1) < 0.01, f"driven plate {body}: mean force {beside:.5g} N/m, alone {alone:.5g}")
    whole = [abs(a + b - c) for a, b, c in zip(two["left.force.y [N/m]"], two["right.force.y [N/m]"], two["force.y [N/m]"])]
    expect(max(whole) <= 1e-9 * max(map(abs, two["force.y [N/m]"])), "the forces on the bodies add up to force.y")

    # Names in the files of the run.
    for file in ("left.log", "right.log", "frames/left-000000.h5", "frames/right-000001.h5"):
        expect((runs / "two" / file).exists(), f"{file} is there")
    record = json.loads((runs / "two" / "run.json").read_text())
    expect(set(record["participants"]) == {"fluid", "left", "right"}, "run.json names the bodies")
    picture = strake("picture", runs / "two", "-o", place / "two.svg", cwd=place)
    expect(picture.returncode == 0 and (place / "two.svg").stat().st_size > 1000, "a picture of both is drawn")
    report = strake("report", runs / "two", "-o", place / "two.html", cwd=place)
    expect(report.returncode == 0, f"a report is made {report.stderr}")

    # The record plays each body's own part.
    done = strake("replay", runs / "two", "--onto", "two.toml", "--side", "structure", "--runs", runs, cwd=place)
    replayed = columns(runs / "two-replay") if done.returncode == 0 else {}
    expect(done.returncode == 0 and max(abs(a - b) for a, b in zip(replayed["left.force.y [N/m]"], two["left.force.y [N/m]"]))
           <= 1e-6 * max(map(abs, two["left.force.y [N/m]"])), f"a replay of both bodies gives the same force {done.stderr}")

    # Two floors, one in Python, one of finite elements; beside each other as alone.
    run_case(place, FLOORS, "--strict")
    both = columns(runs / "two_floors")
    text = FLOORS.read_text()
    head, tail = text.split("[[structures]]\n", 1)[0], "[coupling.surface]" + text.split("[coupling.surface]", 1)[1]
    bodies = text.split("[[structures]]\n")[1:]
    bodies[1] = bodies[1].split("[coupling.surface]")[0]
    spring = ROOT / "cases" / "python_spring" / "spring.py"
    iterations = []
    for body, table, box, probe in (("left", bodies[0], "[[-1.1, -0.3, 0.0], [-0.1, 1.5, 0.0]]", "floor"),
                                    ("right", bodies[1], "[[0.1, -0.3, 0.0], [1.1, 1.5, 0.0]]", "mid")):
        own = "[structure]\n" + table.replace(f'name = "{body}"\n', "").replace("[structures.", "[structure.")
        lines = [line for line in head.splitlines() if not line.startswith(("tank_polygon", "water"))]
        x = box.split(",")[0].strip("["), box.split(",")[3].strip(" [")
        lines.insert(lines.index("[fluid]") + 1, f"tank = {box}\nwater = [[{x[0]}, 0.0], [{x[1]}, 1.0]]")
        probes = tail.split("[[output.probe]]")
        kept = next(p for p in probes if f'name = "{probe}"' in p).split("[[compare]]")[0].replace(f'of = "{body}"', 'of = "structure"')
        case = "\n".join(lines) + "\n" + own.replace("../python_spring/spring.py", str(spring)) + probes[0] + "[[output.probe]]" + kept
        (place / f"{body}.toml").write_text(case)
        run_case(place, f"{body}.toml", "--set", "end_time=0.022")
        alone = columns(runs / body)
        column = f"{probe}.y [m]"
        largest = max(map(abs, alone[column]))
        off = max(abs(a - b) for a, b in zip(alone[column], both[column]))
        expect(off < 0.01 * largest, f"floor {body}: {off:.2e} m off the run alone, largest {largest:.3e} m")
        iterations.append(mean(alone["iterations [1]"]))
    together = mean(both["iterations [1]"])
    expect(together <= 1.2 * max(iterations), f"{together:.2f} iterations a window; alone {iterations[0]:.2f} and {iterations[1]:.2f}")

    # Resumed runs end in the same bytes.
    run_case(place, FLOORS, "--tag", "parts", "--set", "end_time=0.02", "--set", "run.checkpoint_windows=40")
    run_case(place, FLOORS, "--tag", "parts", "--resume", "--set", "run.checkpoint_windows=40")
    expect((runs / "two_floors-parts" / "history.csv").read_bytes() == (runs / "two_floors" / "history.csv").read_bytes(),
           "a resumed run has the same history.csv")

    # What is refused, with the names of the bodies.
    (place / "near.toml").write_text(plates(0.02, -1, 1, -0.1, 0.11))
    done = run_case(place, "near.toml", code=3)
    expect("left and right" in done.stderr and "apart" in done.stderr, "bodies that are too near: " + done.stderr.strip())
    done = run_case(place, "two.toml", "--tag", "x", "--attach", "centre", code=2)
    expect("the case has no centre" in done.stderr, "a side that is not there: " + done.stderr.strip())
    meet = plates(0.05, -1, 1, -0.5, 0.0).replace("velocity = [0.0, -1.0, 0.0]", "velocity = [8.0, 0.0, 0.0]", 1)
    (place / "meet.toml").write_text(meet)
    done = run_case(place, "meet.toml", code=4)
    expect("left and right" in done.stderr and "no contact" in done.stderr, "bodies that meet: " + done.stderr.strip())
    expect((runs / "meet" / "history.csv").exists(), "what was computed before stays")
    done = strake("check", "two.toml", cwd=place)
    expect(done.returncode == 0 and "left, by discretisation" in done.stdout, "check describes each body")
finish()
