"""The guard of a run. A value that a case cannot have raises an alarm at once. The alarm stands on the console, in the
summary and in the report, and --strict ends with 1. Cases that are right raise none."""
import csv
import hashlib
import json
import math
import pathlib
import sys

import h5py

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent))
from processes import *  # noqa: F403: the test's own vocabulary

CASES = ROOT / "cases"
ONE = ["--set", "run.threads=1"]


def run(place, case, *words, code=0):
    result = strake("run", case, *ONE, *words, cwd=place, timeout=280)
    expect(result.returncode == code, f"{' '.join(map(str, words))}: exit {result.returncode}, not {code}\n{result.stderr}")
    return result


def summary(place, name):
    return json.loads((place / "runs" / name / "summary.json").read_text())


def column(place, name, wanted):
    with open(place / "runs" / name / "history.csv") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    k = [title.split(" [")[0] for title in rows[0]].index(wanted)
    return [float(row[k] or "nan") for row in rows[1:]]


def sound(place, case, *words):
    """A case that is right: no alarm, no bad grade."""
    result = run(place, case, "--tag", "sound", "--force", *words)
    found = summary(place, f"{case.stem}-sound")
    grades = {key: entry["grade"] for key, entry in found["checks"]["grades"].items()}
    expect(found["alarms"] == [] and "alarm" not in result.stdout, f"{case.stem} raises no alarm\n{found['alarms']}")
    expect("bad" not in grades.values(), f"{case.stem}: no check is bad, {grades}")


def speeds(place, *words):
    """The wedge of a newcomer at the old default step: where the water is faster than the jet of theory, an alarm says so."""
    case = CASES / "wedge_entry.toml"
    run(place, case, "--tag", "fast", "--set", "structure.wedge.deadrise=25", "--set", "fluid.spacing=0.0125",
        "--set", "fluid.tank=[[-0.5,-0.375],[0.5,0.5]]", "--set", "fluid.water=[[-0.5,-0.375],[0.5,0]]",
        "--set", "fluid.scheme.time_step=2e-6", "--set", "coupling.surface.window=1e-5", "--set", "end_time=0.007")
    found = summary(place, "wedge_entry-fast")
    jet = 1.3 * math.pi * 6 / math.tan(math.radians(25))
    largest = max(column(place, "wedge_entry-fast", "water.largest_speed"))
    kinds = [alarm["kind"] for alarm in found["alarms"]]
    print(f"      water at {largest:.1f} m/s, jet + 30 %: {jet:.1f} m/s, alarms {kinds}")
    expect(("speed" in kinds) == (found["checks"]["largest_speed"] > 1), f"wedge of 25 degrees: {kinds}")
    expect(largest < jet or "speed" in kinds, "water faster than the jet of theory raises an alarm")
    expect("too few for forces" in "".join(found["resolution"]), f"ten spacings are too few\n{found['resolution']}")


CYLINDER = """
end_time = 0.01
[fluid]
dimension = 2
spacing = 0.01
sound_speed = inf
tank = [[-0.8, -1.0], [0.8, 0.4]]
water = [[-0.8, -1.0], [0.8, 0.0]]
submerged = true
[fluid.scheme]
time_step = 1e-3
[structure]
solver = "rigid"
mass = 15.708
free = { y = true }
BODY
[coupling.surface]
window = 1e-3
[output]
every = 0.01
"""


def released(place):
    """A light cylinder, let go under water, rises with 3.2 m/s^2. Where it falls instead it has lost its water."""
    case = place / "cylinder.toml"
    case.write_text(CYLINDER.replace("BODY", "[structure.cylinder]\nradius = 0.1\ncentre = [0.0, -0.5, 0.0]"))
    run(place, case)
    found = summary(place, "cylinder")
    speed = column(place, "cylinder", "body.vy")[4]
    kinds = [alarm["kind"] for alarm in found["alarms"]]
    print(f"      after 5 ms the cylinder has {speed:.4f} m/s, alarms {kinds}")
    expect((speed < 0) == ("dry" in kinds), "a cylinder that falls where it should rise raises an alarm")
    case = place / "box.toml"
    case.write_text(CYLINDER.replace("BODY", "outline = [[-0.1, -0.6, 0], [0.1, -0.6, 0], [0.1, -0.4, 0], [-0.1, -0.4, 0]]"))
    run(place, case)
    expect(summary(place, "box")["alarms"] == [], "a box whose faces lie on the lattice keeps its water")


def doctored(place):
    """One particle of a checkpoint gets 100 m/s: the resumed run says so, whatever the method does next."""
    case = CASES / "dam_break.toml"
    words = ["--tag", "fast", "--set", "run.checkpoint_windows=20", "--set", "end_time=0.05", "--set", "fluid.spacing=0.0073"]
    run(place, case, *words, "--strict")
    checkpoint = (place / "runs" / "dam_break-fast" / "checkpoint" / "latest").resolve()
    with h5py.File(checkpoint / "fluid.h5", "r+") as file:
        file["real/velocity"][0, 0] = 100
    lines = []
    for line in (checkpoint / "checksums").read_text().splitlines():
        name = line.split()[2]
        data = (checkpoint / name).read_bytes()
        lines.append(f"{hashlib.blake2b(data, digest_size=32).hexdigest()} {len(data)} {name}\n")
    (checkpoint / "checksums").write_text("".join(lines))
    result = run(place, case, *words, "--resume", "--strict", code=1)
    told = [line for line in result.stdout.splitlines() if line.strip().startswith("alarm ")]
    expect(len(told) > 0 and "m/s" in told[0] and "try" in told[0], f"one line says what is wrong and what to try\n{result.stdout}")
    expect(result.stdout.find(told[0] if told else "alarm") < result.stdout.find("done  "), "at once, not at the end")
    expect(sum("m/s, where" in line for line in told) == 1, "it is said once")
    expect("alarms: speed from" in result.stdout or "alarm: speed from" in result.stdout, "the end of the run counts it")
    found = summary(place, "dam_break-fast")
    expect(found["alarms"][0]["kind"] == "speed" and len(found["alarms"]) == len(told), "it stands in summary.json")
    expect(found["checks"]["grades"]["largest_speed"]["grade"] == "bad", "its check is bad")
    page = strake("report", place / "runs" / "dam_break-fast", cwd=place)
    text = (place / "runs" / "dam_break-fast" / "report.html").read_text()
    expect(page.returncode == 0 and "Alarms" in text and "not checked against a second spacing" in text,
           "the report says both")


with folder() as name:
    place = pathlib.Path(name)
    doctored(place)
    released(place)
    speeds(place)
    sound(place, CASES / "still_tank.toml", "--set", "end_time=0.1")
    sound(place, CASES / "dam_break.toml")
    sound(place, CASES / "wedge_entry.toml", "--set", "fluid.spacing=0.01", "--set", "end_time=0.006")
    sound(place, CASES / "plate_entry.toml", "--set", "structure.solver=rigid", "--set", "end_time=2.3e-3")
finish()
