"""Air under a flat plate that falls on water: the layer takes the peak, keeps its mass, and does not depend on threads,
rewinds or an interruption. What it cannot do is refused."""
import json
import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent))
from processes import *  # noqa: F403: the test's own vocabulary

CASE = """title = "air under a plate"
end_time = 0.0036
[fluid]
dimension = 2
spacing = 0.01
tank  = [[-0.5, -0.25, 0.0], [0.5, 0.25, 0.0]]
water = [[-0.5, -0.25, 0.0], [0.5, 0.0, 0.0]]
air = { layer = true }
[structure]
solver = "rigid"
velocity = [0.0, -4.0, 0.0]
[structure.plate]
length = 0.2
thickness = 0.02
bottom = [0.0, 0.012, 0.0]
supports = { left = "clamped", right = "clamped" }
[output]
every = 1e-3
"""
A, V, CONTACT = 0.1, 4.0, 0.003  # the peaks come within 0.12 ms of nominal contact


def rows(run):
    try:
        return max(0, len((run / "history.csv").read_text().splitlines()) - 1)
    except OSError:
        return 0


def table(run):
    lines = [line for line in (run / "history.csv").read_text().splitlines() if not line.startswith("#")]
    names = [title.split(" [")[0] for title in lines[0].split(",")]
    return {name: [float(line.split(",")[k] or "nan") for line in lines[1:]] for k, name in enumerate(names)}


def run(place, tag, *words, code=0):
    result = strake("run", "case.toml", "--tag", tag, *words, cwd=place, timeout=240)
    expect(result.returncode == code, f"{tag}: exit {result.returncode}\n{result.stderr}")
    return place / "runs" / f"case-{tag}"


def the_layer_takes_the_peak(place):
    with_air, without = run(place, "air"), run(place, "none", "--set", "fluid.air.layer=false", "--set", "end_time=0.0032")
    air, bare = table(with_air), table(without)
    peak, impact = max(air["force.y"]) / (2 * A), max(bare["force.y"]) / (2 * A)
    rho_c_v = 1000 * 1500 * V
    print(f"      plate-mean peak {peak / 1e6:.2f} MPa with air, {impact / 1e6:.2f} MPa without, rho c V {rho_c_v / 1e6:.2f} MPa")
    expect(0.15 * rho_c_v < peak < 0.75 * rho_c_v, "the air lowers the peak of a flat impact")
    expect(impact > 0.9 * rho_c_v, "without air it is rho c V")
    at_contact = min(range(len(air["time"])), key=lambda k: abs(air["time"][k] - CONTACT))
    left = air["air.mass"][at_contact] / (1.204 * 2 * A)
    print(f"      air left at nominal contact {1e3 * left:.2f} mm of 12")
    expect(0.7e-3 < left < 3e-3, "a millimetre or two of the air is trapped")
    # Slow flow: the cushion rho V^2 a^2/h^2 over water that hardly moves yet, at half the gap.
    early = min(range(len(air["time"])), key=lambda k: abs(air["time"][k] - 0.5 * CONTACT))
    cushion = 1.204 * V * V * A * A / (0.012 - V * air["time"][early]) ** 2
    expect(0.8 < air["air.largest_pressure"][early] / cushion < 1.2, "before that it is the cushion of slow air")
    found = json.loads((with_air / "summary.json").read_text())["checks"]
    expect(abs(found["air_mass"]) <= 1e-12, f"air is neither made nor lost: {found['air_mass']}")
    expect(found["momentum_gap"] < 0.05, f"momentum of water, plate and air: {found['momentum_gap']}")
    expect("air_mass" not in json.loads((without / "summary.json").read_text())["checks"], "without a layer nothing is said of it")
    return with_air


def it_is_exact(place, whole):
    """One run shows both: on two threads, interrupted and resumed."""
    process = start("run", "case.toml", "--tag", "cut", "--set", "run.threads=2", cwd=place)
    cut = place / "runs" / "case-cut"
    expect(wait_until(lambda: rows(cut) >= 150, 60), "resume: the run is under way")
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    again = strake("run", "case.toml", "--tag", "cut", "--resume", "--set", "run.threads=2", cwd=place, timeout=120)
    expect(again.returncode == 0, f"resume: exit {again.returncode}\n{again.stderr}")
    expect((cut / "history.csv").read_bytes() == (whole / "history.csv").read_bytes(), "two threads and a resume: the same to the byte")


def an_elastic_plate_feels_it(place):
    """Windows are repeated until plate and water agree, with air between them."""
    elastic = run(place, "fem", "--set", "structure.solver=fem", "--set", "end_time=0.0033")
    checks = json.loads((elastic / "summary.json").read_text())["checks"]
    expect(abs(checks["air_mass"]) <= 1e-12 and checks["work_gap"] < 1e-9, f"fem: {checks}")


IN_SPACE = """title = "air under a square plate"
end_time = 0.0033
[fluid]
dimension = 3
spacing = 0.02
tank  = [[-0.2, -0.16, -0.2], [0.2, 0.16, 0.2]]
water = [[-0.2, -0.16, -0.2], [0.2, 0.0, 0.2]]
air = { layer = true }
[structure]
solver = "rigid"
depth = 0.2
velocity = [0.0, -4.0, 0.0]
[structure.plate]
length = 0.2
thickness = 0.04
bottom = [0.0, 0.012, 0.0]
[output]
every = 1e-3
[[output.probe]]
name = "gap"
of = "fluid"
at = [0.0, 0.012, 0.0]
quantity = "gap"
[[output.probe]]
name = "rise"
of = "fluid"
at = [0.0, 0.012, 0.0]
quantity = "air_pressure"
"""


def a_plate_in_space_has_it(place):
    (place / "case.toml").write_text(IN_SPACE)
    square = run(place, "square")
    air = table(square)
    early = min(range(len(air["time"])), key=lambda k: abs(air["time"][k] - 0.5 * CONTACT))
    # Between that of a square without the border's speed, 0.295, and that of a strip, 1: a disc has 0.375.
    cushion = 1.204 * V * V * A * A / air["gap"][early] ** 2
    share = air["rise"][early] / cushion
    print(f"      square plate: cushion {share:.3f} rho V^2 a^2/h^2")
    expect(0.33 < share < 0.55, f"the cushion of a square is near that of a disc: {share}")
    expect(max(air["force.y"]) / 0.04 < 0.75 * 1000 * 1500 * V, "the air lowers the peak of a flat impact in space")
    checks = json.loads((square / "summary.json").read_text())["checks"]
    expect(abs(checks["air_mass"]) <= 1e-12 and abs(checks["momentum_gap"]) < 0.1, f"square: {checks}")
    two = run(place, "square2", "--set", "run.threads=2", "--set", "end_time=0.0006")
    short, whole = ((folder / "history.csv").read_text().splitlines() for folder in (two, square))
    same = [x == y for x, y in zip(short[:-1], whole)]  # the last window ends with the run
    expect(len(same) > 50 and all(same), f"two threads: the same to the byte: {sum(same)} of {len(same)} lines")
    result = strake("check", "case.toml", "--set", "fluid.air.layer=false", cwd=place)
    expect(result.returncode == 3 and 'output.probe "gap"' in result.stderr and "fix:" in result.stderr,
           f"a probe of air that is not computed: exit {result.returncode}\n{result.stderr}")


def what_it_cannot_do_is_refused(place):
    for words, message in [(["fluid.air.pressure=-1"], "fluid.air.pressure"), (["fluid.air.film=0"], "fluid.air.film"),
                           (["fluid.air.gamma=1"], "fluid.air.gamma"), (["preset=paper"], "fluid.air.layer"),
                           (["structure.plate.bottom=[0,-0.1,0]", "fluid.submerged=true"], "fluid.air.layer"),
                           (["fluid.air.presure=1"], "did you mean pressure"),
                           (["structure.solver=none"], "fluid.air.layer")]:
        sets = [part for word in words for part in ("--set", word)]
        result = strake("check", "case.toml", *sets, cwd=place)
        expect(result.returncode == 3 and message in result.stderr and "fix:" in result.stderr,
               f"{words}: exit {result.returncode}\n{result.stderr}")


with folder() as name:
    place = pathlib.Path(name)
    (place / "case.toml").write_text(CASE)
    whole = the_layer_takes_the_peak(place)
    it_is_exact(place, whole)
    an_elastic_plate_feels_it(place)
    what_it_cannot_do_is_refused(place)
    a_plate_in_space_has_it(place)
finish()
