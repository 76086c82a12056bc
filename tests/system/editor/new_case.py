"""strake new: every kind passes check and says each key's unit. Questions, refusals, files left alone; one case runs."""
import json
import os
import pathlib
import pty
import re
import select
import sys
import tomllib

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent))
from processes import *  # noqa: F403: the test's own vocabulary

MESH = ROOT / "cases" / "wedge_elastic.msh"
KINDS = {"plate": "", "wedge": "", "box": "", "bodies": "", "cylinder": "", "sphere": "", "mesh": f"--mesh {MESH}", "moored": "", "dam": ""}


def units(place):
    """Key → its unit, from the schema of the case file."""
    found = {}

    def walk(schema, where):
        for name, key in schema.get("properties", {}).items():
            unit = re.search(r"Unit: (.+?)(?:\. |\.$)", key.get("description", ""))
            found[f"{where}{name}"] = unit.group(1) if unit else ""
            walk(key.get("items", key), f"{where}{name}.")
    schema = json.loads(strake("explain", "--schema", cwd=place).stdout)
    walk(schema, "")
    for side in ("fluid", "structure", "structures"):
        walk(schema["definitions"][f"{side}_keys"], f"{side}.")
    return found


def comments_hold(kind, text, unit_of):
    table, bare = "", []
    for line in text.splitlines():
        if head := re.match(r"\[+([\w.]+)\]+", line):
            table = head.group(1) + "."
        elif key := re.match(r"(\w+) = (.*?) +# (.+)$", line):
            unit = unit_of.get(table + key.group(1), "")
            if unit and not re.match(re.escape(unit) + r"\b|" + re.escape(unit) + r"$", key.group(3)):
                bare.append(f"{table}{key.group(1)} [{unit}]: {key.group(3)}")
        elif re.match(r"\w+ =", line):
            bare.append(line)
    expect(not bare, f"{kind}: each key has a comment that begins with its unit {bare}")


def kinds_pass_check(place, unit_of):
    listed = strake("new", "--help", cwd=place).stdout
    for kind, words in KINDS.items():
        expect(re.search(rf"^  {kind} ", listed, re.M), f"new --help lists {kind}")
        made = strake("new", kind, *words.split(), cwd=place)
        file = place / f"{kind}.toml"
        expect(made.returncode == 0 and f"strake run {kind}.toml" in made.stdout, f"new {kind}: exit {made.returncode}\n{made.stderr}")
        comments_hold(kind, file.read_text(), unit_of)
        idle = re.findall(r"^# window = .*", file.read_text(), re.M)
        expect(not idle, f"{kind}: no window waits behind a #, with a value that is not this case's {idle}")
        checked = strake("check", file, *without_fem(file), cwd=place)
        expect(checked.returncode == 0, f"check {kind}.toml: exit {checked.returncode}\n{checked.stderr}")
        coarse = "too few for forces"
        expect((coarse in checked.stdout) <= (coarse in file.read_text()), f"{kind}: what check says of the resolution stands in the file")
        far_off = [line for line in checked.stdout.splitlines() if "Strake would take" in line]
        expect(not far_off, f"{kind}: no key is far from what Strake would take {far_off}")


def without_fem(file):
    built = (BIN / "strake-structure-fem").exists() or 'solver = "fem"' not in file.read_text()
    return [] if built else ["--set", "structure.solver=rigid"]


def box_of_stl(low, high):
    sides = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    at = [" ".join(str((low, high)[k >> axis & 1][axis]) for axis in range(3)) for k in range(8)]
    corners = [three for a, b, c, d in sides for three in ((a, b, c), (a, c, d))]
    facets = ("facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {at[k]}\n" for k in three) + "endloop\nendfacet\n" for three in corners)
    return "solid box\n" + "".join(facets) + "endsolid box\n"


def options_arrive(place):
    made = strake("new", "wedge", "--angle", "20", "--speed", "7", "--width", "0.3", "--mass", "50", "--spacing", "0.01", "-o", "my.toml", cwd=place)
    case = tomllib.loads((place / "my.toml").read_text())
    body = case["structure"]
    expect(made.returncode == 0 and body["wedge"]["deadrise"] == 20 and body["wedge"]["width"] == 0.3, f"angle and width {body}")
    expect(body["velocity"] == [0, -7, 0] and body["mass"] == 50 and body["free"] == {"y": True}, f"speed and mass {body}")
    expect(case["fluid"]["spacing"] == 0.01, "spacing")
    flat = strake("new", "plate", "--solver", "particle", "--length", "0.6", "--thickness", "0.015", "-o", "flat.toml", cwd=place)
    spacing = tomllib.loads((place / "flat.toml").read_text())["structure"]["particle"]["spacing"]
    whole = [abs(length / spacing - round(length / spacing)) < 1e-6 for length in (0.6, 0.015)]
    expect(flat.returncode == 0 and all(whole), f"a lattice of {spacing} fills the plate")
    particle = (BIN / "strake-structure-particle").exists()
    checked = strake("check", "flat.toml", *([] if particle else ["--set", "structure.solver=rigid"]), cwd=place)
    expect(checked.returncode == 0, f"check flat.toml: exit {checked.returncode}\n{checked.stderr}")
    strake("new", "mesh", "--mesh", ROOT / "cases" / "flag.msh", "-o", "off.toml", cwd=place)
    checked = strake("check", "off.toml", cwd=place)
    expect(checked.returncode == 0, f"a mesh away from the origin: exit {checked.returncode}\n{checked.stderr}")
    elastic = re.sub(r"(?m)^# (\[|density|young|poisson|on|kind)", r"\1", (place / "off.toml").read_text()).replace("NAME", "cylinder")
    (place / "elastic.toml").write_text(elastic.replace('solver = "rigid"', 'solver = "particle"' if particle else 'solver = "rigid"'))
    checked = strake("check", "elastic.toml", cwd=place)
    expect(checked.returncode == 0 or not particle, f"the lines of an elastic body: exit {checked.returncode}\n{checked.stderr}")
    stl = place / "box.stl"  # in mm, away from the origin along all axes
    stl.write_text(box_of_stl((2000, 500, -4000), (2400, 700, -3500)))
    made = strake("new", "mesh", "--mesh", "box.stl", "--scale", "0.001", "--spacing", "0.04", "-o", "box_stl.toml", cwd=place)
    checked = strake("check", "box_stl.toml", cwd=place)
    expect(checked.returncode == 0 and "mass 312 kg" in checked.stdout,
           f"an STL file in mm, away from the origin: exit {checked.returncode}\n{made.stderr}{checked.stderr}")
    (place / "bar.stl").write_text(box_of_stl((0, 0, 0), (1.0, 0.05, 0.05)))
    strake("new", "mesh", "bar.stl", "--spacing", "0.1", "-o", "bar.toml", cwd=place)
    checked = strake("check", "bar.toml", cwd=place)
    expect(checked.returncode == 0, f"a coarse spacing of a slender body: exit {checked.returncode}\n{checked.stderr}")
    word = strake("new", "mesh", "box.stl", "--scale", "0.001", "-o", "word.toml", cwd=place)
    page = strake("new", "mesh", "--help", cwd=place).stdout
    expect("REQUIRED" not in page and page.count("by its name alone, or after --mesh") == 2, f"the file is needed once\n{page}")
    none = strake("new", "mesh", "-o", "none.toml", cwd=place)
    expect(none.returncode == 2 and "needs a mesh file" in none.stderr, f"no file: exit {none.returncode} {none.stderr}")
    expect(word.returncode == 0, f"the file without --mesh: exit {word.returncode} {word.stderr}")
    expect("0.5 m wide, 0.2 m high" in (place / "box_stl.toml").read_text(), "its size stands in the file")
    (place / "below").mkdir()
    strake("new", "mesh", "--mesh", os.path.relpath(MESH, place), "-o", "below/hull.toml", cwd=place)
    checked = strake("check", "below/hull.toml", cwd=place)
    expect(checked.returncode == 0, f"a mesh is found from the case file's folder: exit {checked.returncode}\n{checked.stderr}")


def space_is_small(place):
    """A case of a body in space has about 100 000 particles whatever the body's shape, and says what a finer one costs."""
    for shape, size in {"cube": (0.4, 0.3, 0.4), "hull": (20, 1.5, 3), "panel": (1, 0.02, 1), "blade": (0.02, 1, 1)}.items():
        (place / f"{shape}.stl").write_text(box_of_stl((0, 0, 0), size))
        made = strake("new", "mesh", "--mesh", f"{shape}.stl", "-o", f"{shape}.toml", cwd=place)
        expect(made.returncode == 0, f"new mesh of {shape}: exit {made.returncode}\n{made.stderr}")
        text = (place / f"{shape}.toml").read_text()
        costs = re.compile(r"half[^\n]*: ([\d.]+) times the particles, ([\d.]+) times the time")
        expect(costs.search(made.stdout) and costs.search(text), f"{shape}: half the spacing's cost {made.stdout}")
        checked = strake("check", f"{shape}.toml", cwd=place).stdout
        counted = re.search(r"steps of ([\d ]+) particles: some [\d.]+ (?:s|min) on one core", checked)
        expect(counted and 60e3 < float(counted.group(1).replace(" ", "")) < 120e3, f"{shape}: 60 000 to 120 000 particles\n{checked}")
        expect("warning" not in checked, f"{shape}: no warning\n{checked}")
        said = re.search(r"about ([\d ]+) particles", made.stdout)
        expect(said and counted and said.group(1) == counted.group(1), f"{shape}: the console's number is that of check {made.stdout}")


def a_ship_stands_upright(place):
    """A ship's file has z up: --up z turns body and tank. In the plane there is no such axis."""
    (place / "ship_z.stl").write_text(box_of_stl((0, -0.2, 1), (2, 0.2, 1.3)))
    made = strake("new", "mesh", "ship_z.stl", "--up", "z", "-o", "upright.toml", cwd=place)
    expect(made.returncode == 0 and "2 m wide, 0.3 m high" in (place / "upright.toml").read_text(), f"--up z: exit {made.returncode}\n{made.stderr}")
    checked = strake("check", "upright.toml", cwd=place)
    expect(checked.returncode == 0 and "centre of gravity (1, 1.15, 0) m" in checked.stdout, f"the body is turned: exit {checked.returncode}\n{checked.stdout}{checked.stderr}")
    made = strake("new", "mesh", "ship_z.stl", "-o", "lying.toml", cwd=place)
    expect("--up z" in (place / "lying.toml").read_text(), "a case in space says which axis of the file points up")
    flat = strake("new", "mesh", MESH, "--up", "z", "-o", "in_plane.toml", cwd=place)
    expect(flat.returncode == 2 and "plane z = 0" in flat.stderr, f"--up z in the plane: exit {flat.returncode}\n{flat.stderr}")


def millimetres_are_warned_of(place):
    """A body larger than any ship: the console and the case name --scale. One of a ship's size: they do not."""
    for name, size, words, warns in (("mm", (400, 200, 500), "", True), ("long_mm", (1500, 60, 90), "", True), ("m", (400, 200, 500), "--scale 0.001", False),
                                     ("ship", (60, 30, 330), "", False), ("cm", (40, 20, 50), "--scale 10", True)):
        (place / f"{name}.stl").write_text(box_of_stl((0, 0, 0), size))
        made = strake("new", "mesh", "--mesh", f"{name}.stl", *words.split(), "-o", f"size_{name}.toml", cwd=place)
        hint = "--scale 0.01." if name == "cm" else "--scale 0.001."
        for where, text in (("console", made.stdout + made.stderr), ("case", (place / f"size_{name}.toml").read_text())):
            expect((hint in text and "larger than any ship" in text) == warns, f"{name}: warned of on the {where}: {warns}\n{made.stderr}")
    made = strake("new", "plate", "--length", "400", "--thickness", "20", "-o", "size_plate.toml", cwd=place)
    expect("--length 0.4 if it was meant in mm" in made.stderr, f"a plate in mm: {made.stderr}")
    section = place / "section.msh"  # in the plane, in mm
    section.write_text("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 300 0 0\n3 300 90 0\n4 0 90 0\n$EndNodes\n"
                       "$Elements\n1\n1 3 2 1 1 1 2 3 4\n$EndElements\n")
    made = strake("new", "mesh", "--mesh", "section.msh", "-o", "section.toml", cwd=place)
    expect("300 m across" in made.stderr and made.returncode == 0, f"a section in mm: exit {made.returncode} {made.stderr}")


def refusals_help(place):
    before = (place / "wedge.toml").read_bytes()
    for words, code, said in (
            ("wedge", 2, "exists already"), ("wedge --angle 95 -o x.toml", 2, "expected 4 to 80 deg"),
            ("wedge --angle steep -o x.toml", 2, "--angle"), ("wedge --speed nan -o x.toml", 2, "expected 0.01 to 100 m/s"),
            ("wedge --spacing 0.2 -o x.toml", 2, "a tenth of the width"), ("plate --thickness 0.3 -o x.toml", 2, "a quarter of the length"),
            ("plate --solver particle --thickness 0.0137 -o x.toml", 2, "--solver fem"), ("plate --solver fme -o x.toml", 2, "fem"),
            ("dam --height 9 -o x.toml", 2, "ten widths"), ("cylinder --mass -1 -o x.toml", 2, "expected 0.001"), ("mesh -o x.toml", 2, "--mesh"), ("mesh --mesh nothing.msh -o x.toml", 3, "nothing.msh"),
            (f"mesh --mesh {ROOT / 'README.md'} -o x.toml", 3, "ends in .msh"), ("wegde -o x.toml", 2, "did you mean wedge?"),
            ("box.stl -o x.toml", 2, "strake new mesh box.stl"), ("mesh --mesh box.stl --scale 0 -o x.toml", 2, "expected 1e-06 to 1e+06: factor"),
            ("", 2, "expected a kind of case"), ("wedge -o none/x.toml", 6, "none")):
        refused = strake("new", *words.split(), cwd=place)
        expect(refused.returncode == code and said in refused.stderr, f"new {words}: exit {refused.returncode}, {refused.stderr.strip()}")
        expect(code == 6 or "fix:" in refused.stderr or "--help" in refused.stderr, f"new {words}: says what to do")
    expect(not (place / "x.toml").exists(), "what is refused leaves no file")
    expect((place / "wedge.toml").read_bytes() == before, "an existing file is not touched")


def on_terminal(place, words, answers):
    """Exit code and screen of `strake new` on a terminal that gives these answers, each when it is asked for one."""
    pid, terminal = pty.fork()
    if pid == 0:
        os.chdir(place)
        os.execve(BIN / "strake", ["strake", "new", *words], ENV)
    screen, left, end_of_wait = "", list(answers), time.monotonic() + 20
    while time.monotonic() < end_of_wait:
        if not select.select([terminal], [], [], 0.2)[0]:
            continue
        try:
            new = os.read(terminal, 4096).decode(errors="replace")
        except OSError:
            break
        if not new:
            break
        screen += new
        if screen.endswith("): ") and left:
            os.write(terminal, (left.pop(0) + "\n").encode())
        elif screen.endswith("): "):
            os.write(terminal, b"\x04")
    os.close(terminal)
    return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]), screen


def questions_are_asked(place):
    code, screen = on_terminal(place, ["-o", "asked.toml"], ["wegde", "wedge", "95", "25", "", "0.4", "", ""])
    expect(code == 0, f"questions: exit {code}\n{screen}")
    expect("expected one of plate, wedge" in screen and "expected 4 to 80 deg" in screen, f"wrong answers are asked for again\n{screen}")
    body = tomllib.loads((place / "asked.toml").read_text())["structure"] if code == 0 else {}
    expect(body.get("wedge", {}).get("deadrise") == 25 and body.get("velocity") == [0, -5, 0], f"answers and defaults arrive {body}")
    code, screen = on_terminal(place, ["cylinder", "-o", "short.toml"], [""])
    expect(code == 2 and "the input ended" in screen and not (place / "short.toml").exists(), f"an end of input: exit {code}\n{screen}")
    code, screen = on_terminal(place, ["cylinder", "--radius", "0.2", "-o", "flags.toml"], [])
    expect(code == 0 and "): " not in screen, f"flags on a terminal: no question\n{screen}")


def one_runs(place):
    strake("new", "wedge", "--spacing", "0.02", "-o", "quick.toml", cwd=place)
    ran = strake("run", "quick.toml", "--set", "end_time=3e-3", cwd=place)
    expect(ran.returncode == 0, f"run quick.toml: exit {ran.returncode}\n{ran.stderr}")
    expect(rows(place / "runs" / "quick") > 3, f"{rows(place / 'runs' / 'quick')} windows")
    summary = json.loads((place / "runs" / "quick" / "summary.json").read_text())
    expect(not summary["alarms"], f"without alarm {summary['alarms']}")


with folder() as name:
    here = pathlib.Path(name)
    kinds_pass_check(here, units(here))
    options_arrive(here)
    space_is_small(here)
    a_ship_stands_upright(here)
    millimetres_are_warned_of(here)
    refusals_help(here)
    questions_are_asked(here)
    one_runs(here)
finish()
