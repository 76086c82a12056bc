"""Wrong input is answered before the first step. The message says where it stands, what was expected and how to fix it;
the exit code is that of its kind. A refused run leaves no run folder."""
import shutil

from processes import *  # noqa: F403: the test's own vocabulary

TEXT = (ROOT / "cases" / "plate_entry.toml").read_text()

# (what, text to replace, replacement, exit code, words that the message must contain)
CASES = [
    ("a misspelt key", "spacing = 0.01 ", "spacng = 0.01 ", 3, ["spacng", "did you mean spacing", "wrong.toml:"]),
    ("a misspelt table", "[structure.material]", "[structure.materiel]", 3, ["materiel", "material"]),
    ("a misspelt top-level table", "[output]", "[outputs]\na = 1\n[output]", 3, ["outputs", "output"]),
    ("a value of wrong type", "young = 2.1e11", 'young = "210 GPa"', 3, ["structure.material.young", "210 GPa", "Pa", "^"]),
    ("E = 0", "young = 2.1e11", "young = 0", 3, ["structure.material.young", "greater than 0", "^"]),
    ("a Poisson ratio out of range", "poisson = 0.3", "poisson = 0.6", 3, ["structure.material.poisson", "0.5"]),
    ("a negative spacing", "spacing = 0.01 ", "spacing = -0.01 ", 3, ["fluid.spacing", "greater than 0"]),
    ("not a number", "density = 1000.0", "density = nan", 3, ["fluid.density"]),
    ("a preset that does not exist", 'preset = "improved"', 'preset = "improve"', 3, ["preset", "improved", "paper"]),
    ("a misspelt key of a side that is absent", 'solver = "fem"', 'solver = "none"\nE = 3', 3,
     ["wrong.toml:", "structure.E", 'solver is "none"', "strake explain structure"]),
    ("a misspelt table of a shape", "[structure.plate]", "[structure.wegde]", 3,
     ["wrong.toml:", "structure.wegde is not a key", "did you mean wedge?"]),
    ("a number with a decimal comma", "spacing = 0.01 ", 'spacing = "0,01" ', 3, ["fluid.spacing", "fix: spacing = 0.01"]),
    ("a solver that does not exist", 'solver = "fem"', 'solver = "femm"', 3, ["structure.solver", "fem"]),
    ("a program without its folder", 'solver = "fem"', 'solver = "spring.py"', 3, ['fix: solver = "./spring.py"']),
    ("a syntax error", "end_time = 0.03", "end_time = = 0.03", 3, ["wrong.toml:"]),
    ("a missing required key", "end_time = 0.03", "", 3, ["end_time"]),
    ("a body outside the tank", "[0.0, 0.012, 0.0]", "[0.9, 0.012, 0.0]", 3, ["tank"]),
    ("a body in the water", "[0.0, 0.012, 0.0]", "[0.0, -0.1, 0.0]", 3, ["water"]),
    ("water outside the tank", "water = [[-1.0, -0.5, 0.0], [1.0, 0.0", "water = [[-1.0, -0.5, 0.0], [1.5, 0.0", 3,
     ["fluid.water"]),
    ("a step longer than the window", "[structure]\n", "[fluid.scheme]\ntime_step = 1e-3\n[structure]\n", 3,
     ["time_step", "window"]),
    ("volume coupling with finite elements", "[output]\n", '[coupling]\ninterface = "volume"\n[output]\n', 3,
     ["volume", "particle"]),
    ("a missing file", 'kind = "theory"\nsource = "potential',
     'file = "reference/none.csv"\nkind = "theory"\nsource = "potential', 3, ["none.csv"]),
    ("one call of CalculiX for a load that is not known", 'solver = "fem"', 'solver = "ccx"\nccx = { calls = "once" }', 3,
     ["structure.ccx.calls", "window", "replay"]),
    ("CalculiX in volume coupling", 'solver = "fem"', 'solver = "ccx"\n[coupling]\ninterface = "volume"\n[structure.fem]', 3,
     ["volume", "particle"]),
]

# Bodies alone, which every solver of them refuses alike.
ALONE = 'end_time = 1e-4\n[fluid]\nsolver = "none"\nspacing = 0.05\n[structure]\nsolver = "fem"\n'
LOADED = '[structure.load]\nkind = "traction"\nvalue = [0, 1e3, 0]\n[structure.particle]\nspacing = 0.05\n'
BOX = '[[structure.box]]\nname = "a"\nmin = [0, 0, 0]\nmax = [1, 0.1, 0]\n'
FROM_FILE = 'mesh = "body.msh"\n[[structure.support]]\non = "clamp"\n'
MESH = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 7 "clamp"
2 1 "steel"
$EndPhysicalNames
$Nodes
8
1 0 0 0
2 1 0 0
3 2 0 0
4 0 1 0
5 1 1 0
6 2 1 0
7 3 1 0
8 3 0 0
$EndNodes
$Elements
3
1 1 2 7 4 4 1
2 3 2 1 1 1 2 5 4
3 3 2 1 1 2 3 6 5
$EndElements
"""
BODIES = [  # what, the structure's keys, (text to replace in the mesh, replacement), words
    ("a broken mesh", FROM_FILE, ("2 3 6 5\n$EndElements\n", "2 3"), ["body.msh:24", "expected 4 nodes"]),
    ("a mesh that is no mesh", FROM_FILE, (MESH, "hello"), ["body.msh", "$MeshFormat"]),
    ("an inverted element", FROM_FILE, ("6 2 1 0", "6 0.5 0.4 0"), ["structure.mesh", "cell 2", "inside out"]),
    ("a twisted element", FROM_FILE, ("1 2 5 4", "1 2 4 5"), ["body.msh", "cell 1", "inside out"]),
    ("unconnected parts of a mesh", FROM_FILE, ("3 3 2 1 1 2 3 6 5", "3 3 2 1 1 3 6 7 8"), ["structure.mesh", "does not touch"]),
    ("a missing physical name", FROM_FILE.replace("clamp", "clmap"), None, ["structure.support[0].on", "clamp", "did you mean"]),
    ("unconnected boxes", LOADED + BOX + BOX.replace("0, 0, 0", "0, 0.2, 0").replace("0.1, 0", "0.3, 0").replace('"a"', '"b"'),
     None, ["structure.box", '"b"', "does not touch"]),
    ("a box turned over", LOADED + BOX.replace("0.1, 0]", "-0.1, 0]"), None, ["structure.box[0].max", "above min"]),
    ("statics of boxes without supports", 'analysis = "static"\n' + LOADED + BOX, None, ["static", "without enough supports"]),
    ("statics of a plate without supports", 'analysis = "static"\n' + LOADED +
     "[structure.plate]\nlength = 1.0\nthickness = 0.1\nbottom = [0, 0, 0]\n", None, ["static", "without enough supports"]),
    ("a Poisson ratio of a half", LOADED + BOX + "[structure.material]\npoisson = 0.5\n", None,
     ["structure.material.poisson", "below 0.5", "^"]),
]


def bodies(place):
    """Every solver says what is wrong with a body, where, and how to mend it, before anything is computed."""
    case = place / "body.toml"
    for what, keys, change, words in BODIES:
        (place / "body.msh").write_text(MESH.replace(*change) if change else MESH)
        case.write_text(ALONE + keys)
        for solver in ("fem", "ccx", "particle"):
            if not (BIN / f"strake-structure-{solver}").exists() or solver == "ccx" and shutil.which("ccx") is None:
                print(f"skip  {what}: {solver} is not built, or ccx not installed (Debian: apt install calculix-ccx)")
                continue
            result = strake("check", case, "--set", f"structure.solver={solver}", cwd=place)
            expect(result.returncode == 3 and all(w in result.stderr for w in words) and "fix:" in result.stderr,
                   f"{what} ({solver}): exit {result.returncode}, the message holds {words}\n{result.stderr.rstrip()}")


with folder() as place:
    place = pathlib.Path(place)
    bodies(place)
    case = place / "wrong.toml"
    for what, old, new, code, words in CASES:
        if TEXT.count(old) < 1:
            expect(False, f"{what}: the case no longer holds {old!r}")
            continue
        everywhere = old.startswith("[")  # the plate takes its probes along
        case.write_text(TEXT.replace(old, new, -1 if everywhere and "," in old else 1))
        result = strake("run", case, cwd=place)
        text = result.stderr
        expect(result.returncode == code, f"{what}: exit {result.returncode}, expected {code}")
        expect(all(w in text for w in words), f"{what}: the message holds {words}\n{text.rstrip()}")
        expect("fix:" in text, f"{what}: the message says how to fix it")
        expect(result.stdout.count("\n") < 30 and "Traceback" not in text, f"{what}: brief")
        expect(not (place / "runs" / "wrong").exists(), f"{what}: no run folder is left")

    text = TEXT
    for old, new in (("end_time = 0.03 ", "end_time = -1 "), ("density = 1000.0", 'density = "heavy"'), ("young = 2.1e11", "E = 2.1e11"),
                     ("poisson = 0.3", "poisson = 7"), ("every = 1.0e-4", "evry = 1.0e-4"), ("thickness = 0.02", "thickness = 0")):
        expect(text.count(old) > 0, f"several errors: the case holds {old!r}")
        text = text.replace(old, new, 1)
    case.write_text(text)
    for command in ("check", "run"):
        said = strake(command, case, cwd=place).stderr
        for words in (": end_time = -1", 'fluid.density = "heavy"', "structure.material.E is not a key", "did you mean young?",
                      "structure.material.poisson = 7", "output.evry is not a key", "structure.plate.thickness = 0"):
            expect(said.count(words) == 1, f"{command} says everything that is wrong, once: {words}\n{said.rstrip()}")

    (place / "nan.csv").write_text("time [s],mid.y [m]\n0,0\n1e-3,nan\n")
    case.write_text(TEXT.replace('kind = "theory"', 'file = "nan.csv"\nkind = "theory"', 1))
    result = strake("run", case, cwd=place)
    expect(result.returncode == 3 and "nan.csv:3" in result.stderr, f"NaN in a reference file\n{result.stderr.rstrip()}")

    for what, words, code in [
        ("no such command", ["fly"], 2), ("no case", ["run"], 2), ("an unknown option", ["run", case, "--fast"], 2),
        ("a case that does not exist", ["run", place / "none.toml"], 3), ("a folder for a case", ["run", place], 3),
        ("a folder beside runs", ["run", "."], 3), ("a decimal comma", ["new", "wedge", "--width", "0,5"], 2),
        ("--set without a value", ["run", case, "--set", "fluid.spacing"], 2),
        ("--set of an unknown key", ["run", ROOT / "cases" / "plate_entry.toml", "--set", "fluid.spacng=0.02"], 3),
        ("--set of a wrong type", ["run", ROOT / "cases" / "plate_entry.toml", "--set", "fluid.spacing=small"], 3),
        ("explain of an unknown key", ["explain", "fluid.spacng"], 2),
        ("compare of no run", ["compare", place / "none"], 3),
    ]:
        result = strake(*words, cwd=place)
        expect(result.returncode == code, f"{what}: exit {result.returncode}, expected {code}\n{result.stderr.rstrip()}")
        expect(len(result.stderr.strip()) > 0, f"{what}: says something")

    empty = place / "empty.py"
    empty.write_text("#!/usr/bin/python3\n")
    empty.chmod(0o755)
    (place / "own.toml").write_text(ALONE.replace('"fem"', '"./empty.py"'))
    own = strake("run", place / "own.toml", cwd=place)
    expect(own.returncode == 5 and "ends with CLASS.main()" in own.stderr, f"a program that does nothing\n{own.stderr}")

    quick = ["run", ROOT / "cases" / "plate_entry.toml", "--set", "structure.solver=rigid", "--set", "end_time=2e-5"]
    first = strake(*quick, cwd=place)
    expect(first.returncode == 0, f"a run of two windows: exit {first.returncode}\n{first.stderr}")
    again = strake(*quick, cwd=place)
    expect(again.returncode == 2 and "--tag" in again.stderr, f"an existing run folder\n{again.stderr.rstrip()}")
    free = strake(*quick, "--first-free-tag", cwd=place)
    expect(free.returncode == 0 and (place / "runs" / "plate_entry-2").is_dir(), "the first free tag is found")
finish()
