"""A co-simulation unit of FMI 3.0 at a floating box: as a spring of ours, resumed, with a shorter step, and where it fails."""
import pathlib
import sys
import zipfile

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent))
from processes import *  # noqa: F403: the test's own vocabulary

FMU = pathlib.Path(sys.argv[3])
BOX = (ROOT / "cases" / "moored_box.toml").read_text()
SPRING = """solver = "spring"
[attachments.spring]
anchor = [[-0.2, -0.2]]
length = 0.0
stiffness = 5000.0
"""
UNIT = f"""solver = "fmu"
[attachments.fmu]
file = "{FMU}"
inputs = ["end.u = displacement.y", "end.w = velocity.y"]
outputs = ["force.y = force"]
parameters = ["k = 5000", "m = 1e30"]
"""


def case(place, name, solver):
    """The box, too heavy for its draught, on one attachment."""
    before, after = BOX.index('solver = "catenary"'), BOX.index("[coupling.surface]")
    text = BOX[:before] + solver + BOX[after:BOX.index("[[compare]]")]
    for old, new in (("at = [[-0.2, -0.2], [0.2, -0.2]]", "at = [[-0.2, -0.2]]"), ("mass = 71.176", "mass = 75.0")):
        expect(old in text, f"the case holds {old}")
        text = text.replace(old, new)
    (place / name).write_text(text)


def run(place, name, *words, code=0, end=0.06):
    done = strake("run", name, "--set", f"end_time={end}", *words, cwd=place)
    expect(done.returncode == code, f"{name} {' '.join(words)}: exit {done.returncode}, expected {code}\n{done.stderr[-600:]}")
    return done


with folder() as name:
    place = pathlib.Path(name)
    runs = place / "runs"
    case(place, "spring.toml", SPRING), case(place, "unit.toml", UNIT)
    run(place, "spring.toml"), run(place, "unit.toml")
    ours, theirs = columns(runs / "spring"), columns(runs / "unit")
    off = max(abs(a - b) for a, b in zip(ours["mooring.force.y [N/m]"], theirs["mooring.force.y [N/m]"]))
    expect(off < 1e-6 and max(map(abs, theirs["mooring.force.y [N/m]"])) > 1, f"a unit that is a spring pulls as a spring of ours: {off:.1e} N/m off")
    expect("mooring.mass(1).x [m]" in theirs, "its outputs are columns")
    strake("report", runs / "unit", cwd=place)
    expect("attachments.mooring.fmu.outputs" in (runs / "unit" / "report.html").read_text(), "the report names keys as --set does")

    with zipfile.ZipFile(FMU) as packed:
        packed.extractall(place / "unpacked")
    run(place, "unit.toml", "--tag", "unpacked", "--set", "attachments.mooring.fmu.file=unpacked")
    expect((runs / "unit-unpacked" / "history.csv").read_bytes() == (runs / "unit" / "history.csv").read_bytes(),
           "a folder into which it was unpacked does as well")
    done = strake("replay", runs / "unit", "--onto", "unit.toml", "--side", "structure", "--set", "end_time=0.03", cwd=place)
    expect(done.returncode == 0, f"the recorded structure is played: exit {done.returncode}\n{done.stderr[-600:]}")
    expect(not any(name.startswith("mooring") for name in columns(runs / "unit-replay")), "nothing is attached to a recorded structure")

    run(place, "unit.toml", "--tag", "parts", "--set", "run.checkpoint=1e-3", end=0.03)
    run(place, "unit.toml", "--tag", "parts", "--set", "run.checkpoint=1e-3", "--resume")
    expect((runs / "unit-parts" / "history.csv").read_bytes() == (runs / "unit" / "history.csv").read_bytes(),
           "a resumed run has the same history.csv")

    fault = "attachments.mooring.fmu.parameters=[\"fault = {}\"]".format
    run(place, "unit.toml", "--tag", "discards", "--set", fault(3), end=0.01)
    expect(len(columns(runs / "unit-discards")["time [s]"]) >= 10, "a step that it discards makes windows shorter")
    done = run(place, "unit.toml", "--tag", "error", "--set", fault(1), code=4)
    expect("mooring" in done.stderr and "the spring broke" in done.stderr, "its own words name the fault: " + done.stderr[:300])

    with zipfile.ZipFile(FMU) as packed, zipfile.ZipFile(place / "stateless.fmu", "w") as changed:
        for entry in packed.namelist():
            changed.writestr(entry, packed.read(entry).replace(b'canGetAndSetFMUState="true"', b""))
    words = ("--set", f"attachments.mooring.fmu.file={place / 'stateless.fmu'}")
    done = run(place, "unit.toml", "--tag", "implicit", *words, code=3)
    expect("cannot take back its state" in done.stderr, "iterations need its state: " + done.stderr[:300])
    run(place, "unit.toml", "--tag", "explicit", *words, "--set", "coupling.surface.converged.max_iterations=1",
        "--set", "coupling.surface.predictor=constant", end=0.01)
    done = run(place, "unit.toml", "--tag", "name", "--set", "attachments.mooring.fmu.inputs=[\"end.v = displacement.y\"]", code=3)
    expect("did you mean end.u?" in done.stderr, "a variable that is not there: " + done.stderr[:300])
finish()
