"""Strake's own solvers as participants of a preCICE run, against the same cases in which Strake's coupler leads them.

    tests/precice/own_solvers.py ROOT BIN
"""
import csv
import json
import shutil
import sys
import time

import h5py
import numpy

sys.path.insert(0, sys.path[0] + "/../system")
from processes import *  # noqa: F403: the system tests' own vocabulary

CASES = ROOT / "tests" / "precice" / "own"
LIBRARY = BIN.parent / "lib" / "strake" / "precice"
PROGRAMS = {"floor": "fem", "entry": "particle", "sphere": "rigid"}
NAMES = {"floor": "Floor", "entry": "Plate", "sphere": "Ball"}


def words_of(case, side, *more):
    """The command line of a participant, as a user types it."""
    program = "strake-fluid" if side == "fluid" else f"strake-structure-{PROGRAMS[case]}"
    name = "Water" if side == "fluid" else NAMES[case]
    return [str(BIN / program), f"{case}.toml", "--precice", f"{case}.xml", "--participant", name, *map(str, more)]


def precice_sets(case, more=lambda side: ()):
    """--set words that make participants with adapters of both sides of a case."""
    sets = []
    for side in ("fluid", "structure"):
        sets += ["--set", f"{side}.solver=precice", "--set", f"{side}.precice.command={json.dumps(words_of(case, side, *more(side)))}"]
    return sets


def run(place, *words, code=0, env=ENV):
    result = subprocess.run(list(map(str, words)), cwd=place, env=env, capture_output=True, text=True, timeout=60)
    expect(result.returncode == code, f"{' '.join(map(str, words[1:6]))}: exit {result.returncode}"
           + (result.stdout + result.stderr if result.returncode != code else ""))
    return result


def record(folder):
    """All numbers of the recorded interface, by name."""
    found = {}
    for file in sorted((folder / "interface").glob("*.h5")):
        with h5py.File(file) as data:
            data.visititems(lambda name, item: found.__setitem__(f"{file.name}/{name}", numpy.array(item))
                            if isinstance(item, h5py.Dataset) else None)
    return found


def table(path):
    with open(path) as lines:
        return list(csv.reader(line for line in lines if not line.startswith("#")))


def same_run(place, case, *sets):
    """The recorded interface and every iteration are equal, byte by byte."""
    run(place, BIN / "strake", "run", f"{case}.toml", "--force", "--tag", "own", *sets)
    began = time.monotonic()
    run(place, BIN / "strake", "run", f"{case}.toml", "--force", "--tag", "precice", *precice_sets(case), *sets)
    took = time.monotonic() - began
    own, other = (place / "runs" / f"{case}-{tag}" for tag in ("own", "precice"))
    left, right = record(own), record(other)
    # A floor that does not write its velocity announces none either.
    left = {name: array for name, array in left.items() if "initial_velocity" not in name or name in right}
    expect(left.keys() == right.keys() and len(left) > 0, f"{case}: the same arrays are recorded: {sorted(left.keys() ^ right.keys())}")
    differ = [name for name in left if left[name].tobytes() != right.get(name, numpy.zeros(0)).tobytes()]
    values = sum(array.size for array in left.values())
    largest = {name: abs(left[name] - right[name]).max() for name in differ if name in right and left[name].shape == right[name].shape}
    expect(not differ, f"{case} {' '.join(sets)}: {values} recorded numbers are the same bytes ({took:.1f} s): {largest}")
    expect((own / "iterations.csv").read_bytes() == (other / "iterations.csv").read_bytes(), f"{case}: the same iterations")
    forces = numpy.concatenate([array.ravel() for name, array in left.items() if "force" in name])
    expect(numpy.abs(forces).max() > 1, f"{case}: the water loads the body: {numpy.abs(forces).max():.4g} N")


def error_with_samples(place, *sets):
    """Largest difference of the displacement to just behind the first peak, over the deflection; and that deflection [m]."""
    run(place, BIN / "strake", "run", "entry.toml", "--force", "--tag", "own", *sets)
    run(place, BIN / "strake", "run", "entry.toml", "--force", "--tag", "precice", *precice_sets("entry", lambda side: sets), *sets)
    left, right = (record(place / "runs" / f"entry-{tag}") for tag in ("own", "precice"))
    name = "000001.h5/real/displacement"
    ends = (left["000001.h5/real/time"] + left["000001.h5/real/dt"]).ravel()
    kept = ends < 1.225e-3
    left, right, ends = (array.reshape(-1, kept.size)[:, kept] for array in (left[name], right[name], ends))
    ends = ends.ravel()
    deflection = numpy.abs(left.reshape(-1, 3, ends.size)[:, 1] + 6.26 * ends).max()
    return numpy.abs(left - right).max() / deflection, deflection


def with_samples(place):
    """The fluid writes the force of each of its steps, the structure reads 8 in a window: near the run in which Strake's coupler hands them on."""
    (place / "entry.xml").write_text((CASES / "entry.xml").read_text().replace('from="Water" to="Plate"', 'from="Water" to="Plate" substeps="true"'))
    for interpolation in ("mean", "linear"):
        # Whether one particle more or less leaves the plate depends on the last bits, in some gaps: 1.2 % without it, 3 to 4 % with it.
        errors = sorted(error_with_samples(place, "--set", f"coupling.surface.interpolation={interpolation}",
                                           "--set", f"structure.plate.bottom=[0.0, {gap}, 0.0]") for gap in (0.0061, 0.0063, 0.0065))
        error, deflection = errors[1]
        expect(error < 0.02, f"samples, {interpolation}: {100 * error:.2f} % of the deflection of {1e3 * deflection:.3f} mm, expected 2 (of three gaps the middle)")


def refused(place, words, code, *said, env=ENV):
    result = subprocess.run(list(map(str, words)), cwd=place, env=env, capture_output=True, text=True, timeout=60)
    lacks = [text for text in said if text not in result.stderr]
    expect(result.returncode == code and not lacks, f"{' '.join(map(str, words[1:]))}: exit {result.returncode}, refused"
           + (f"; lacks {lacks}: {result.stderr}" if lacks or result.returncode != code else f": {result.stderr.splitlines()[0]}"))


def wrong_inputs(place):
    fluid, solid = words_of("floor", "fluid"), words_of("floor", "structure")
    refused(place, fluid[:-1] + ["Wasser"], 3, 'floor.xml: has no participant "Wasser"', "one of: Water, Floor")
    refused(place, fluid[:-2], 2, "--participant: is missing", "the participants of floor.xml: Water, Floor")
    refused(place, [fluid[0], "floor.toml", "--participant", "Water"], 2, "stands without --precice")
    refused(place, [fluid[0], "floor.toml", "--precice", "none.xml", "--participant", "Water"], 3, "none.xml", "cannot be read")
    refused(place, [fluid[0], "--precice", "floor.xml", "--participant", "Water"], 2, "--case: is missing")
    refused(place, [fluid[0], "floor.toml", "--precice", "sphere.xml", "--participant", "Water"], 3,
            'mesh "Water-Mesh" has 3 dimensions, the case has 2')
    refused(place, solid[:-1] + ["Water"], 3, "a structure of Strake reads force")
    text = (place / "floor.xml").read_text()
    (place / "pressure.xml").write_text(text.replace('name="Force"', 'name="Pressure"').replace("data:vector name=\"Pressure\"", "data:scalar name=\"Pressure\"")
                                        .replace('data="Force"', 'data="Pressure"'))
    refused(place, [fluid[0], "floor.toml", "--precice", "pressure.xml", "--participant", "Water"], 3,
            'writes data "Pressure", which stands for pressure', "a fluid of Strake writes force")
    refused(place, fluid + ["--set", "coupling.interface=volume", "--set", "structure.solver=particle"], 3, "coupling.interface = \"volume\"")
    (place / "attached.toml").write_text((place / "floor.toml").read_text() + '\n[[attachments]]\nname = "spring"\nat = [[0, 0]]\nsolver = "spring"\n')
    refused(place, ["attached.toml" if word == "floor.toml" else word for word in fluid], 3, "has [[attachments]]", "participants of that run")
    bare = {key: value for key, value in ENV.items() if key != "LD_LIBRARY_PATH" and not key.startswith("STRAKE_")}
    refused(place, fluid, 2, "preCICE's library cannot be loaded", "libprecice.so.3", "LD_LIBRARY_PATH, which is not set",
            f"for a run of Strake its own library: {LIBRARY}", env=bare)
    refused(place, fluid + ["--precice-library", "none.so"], 2, "--precice-library none.so", "cannot be loaded", env=bare)
    for name, lines, said in (("two", 'const char* precicec_getVersionInformation(void) { return "2.5.0;x"; }', "is version 2.5.0 of preCICE, expected 3"),
                              ("other", "int other(void) { return 0; }", "has no function precicec_getVersionInformation"),
                              ("three", 'const char* precicec_getVersionInformation(void) { return "3.0.0"; }', "has no function precicec_createParticipant")):
        (place / f"{name}.c").write_text(lines)
        subprocess.run(["cc", "-shared", "-fPIC", "-o", f"{name}.so", f"{name}.c"], cwd=place, check=True)
        refused(place, fluid + ["--precice-library", f"{name}.so"], 2, said, env=bare)
    # Outside a run Strake's library says that it takes part in runs of Strake alone.
    refused(place, fluid + ["--precice-library", LIBRARY / "libprecice.so.3"], 4, "STRAKE_CONNECT: is not in the environment", env=bare)
    refused(place, [fluid[0], "floor.toml", "--interface"], 2, "a fluid's interface follows from the structure's")


def other_library(place):
    """A library that is not Strake's: the calls in their order, exact rewinds, and no call of finalize after a fault."""
    subprocess.run(["cc", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", "-o", "recorder.so", "recorder.c"], cwd=place, check=True)
    calls = lambda text: [line for line in text.splitlines() if "[info]" not in line]
    library = ("--precice-library", "recorder.so")
    lines = calls(run(place, *words_of("floor", "fluid", *library, "--into", "recorded")).stdout)
    points = int(lines[1].split()[1])
    expect(lines[:5] == ["create Water floor.xml 0 1", f"Water-Mesh: {points} vertices", f"Water-Mesh: {points} edges from {points - 1}", "write Force 0", "initialize"],
           f"another library: the calls before the run {lines[:5]}")
    forces = [line.split()[2] for line in lines[5:] if line.startswith("write")]
    window = lambda k: ["read Displacement at 0.0005", "read Velocity at 0.0005", f"write Force {forces[k]}", "advance 0.0005"]
    expected = [call for k in (0, 2, 4) for call in ["checkpoint", *window(k), "rewind", *window(k)]] + ["finalize"]
    expect(lines[5:] == expected and len(set(forces)) == 3, f"another library: three windows of two equal iterations, forces {forces[::2]}: {'' if lines[5:] == expected else lines[5:]}")
    expect(len(table(place / "recorded" / "history.csv")) == 4, "another library: a row for each window")
    text = (place / "floor.xml").read_text()
    (place / "samples.xml").write_text(text.replace('from="Water" to="Floor"', 'from="Water" to="Floor" substeps="true"'))
    words = words_of("floor", "fluid", *library)
    words[words.index("floor.xml")] = "samples.xml"
    lines = calls(run(place, *words).stdout)
    expect(lines.count("advance 0.00025") == 12 and "advance 0.0005" not in lines, "another library: with substeps a step for each of the fluid's")
    lines = calls(run(place, *words_of("floor", "structure", *library)).stdout)
    expect(lines[3:7] == ["write Displacement 0", "initialize", "checkpoint", "read Force at 0.0005"], f"another library, structure: {lines[:7]}")
    (place / "names.xml").write_text(text.replace('"Force"', '"Forces0"'))
    words = words_of("floor", "fluid", *library)
    words[words.index("floor.xml")] = "names.xml"
    refused(place, words, 3, 'writes data "Forces0", which stands for Forces0', 'fluid.precice_names = ["Forces0=force"]')
    named = calls(run(place, *words, "--set", 'fluid.precice_names=["Forces0=force"]').stdout)
    expect([line.split()[2] for line in named if line.startswith("write Forces0")] == ["0", *forces], "another library: the case says what a name means")
    began = time.monotonic()
    refused(place, words_of("floor", "fluid", *library), 4, "a spacing beyond the walls of the tank", env=dict(ENV, RECORDER_VALUE="10"))
    expect(time.monotonic() - began < 5, f"another library: a fault ends the process after {time.monotonic() - began:.1f} s, although its finalize waits")


def surface_file(place):
    """The structure's surface as a file of Gmsh's gives the same run as the case's own body."""
    text = run(place, *words_of("floor", "structure")[:2], "--interface").stdout
    expect(text.startswith("$MeshFormat") and '"velocity"' in text, "--interface prints a mesh of Gmsh's with a velocity")
    (place / "floor.msh").write_text(text)
    more = lambda side: () if side == "structure" else ("--set", "structure.solver=precice", "--set", "structure.precice.surface=floor.msh")
    run(place, BIN / "strake", "run", "floor.toml", "--force", "--tag", "surface", *precice_sets("floor", more))
    folders = [place / "runs" / f"floor-{tag}" for tag in ("own", "surface")]
    left, right = map(record, folders)
    expect(all(left[name].tobytes() == right[name].tobytes() for name in right), "a body from a surface file: the same bytes")
    refused(place, [BIN / "strake", "check", "floor.toml", *more("fluid")], 3, "structure.precice.command", "only a preCICE run does without")


def results(place):
    """--into: frames and a history of the participant's own columns."""
    more = lambda side: ("--into", f"own-{side}")
    run(place, BIN / "strake", "run", "floor.toml", "--force", "--tag", "into", *precice_sets("floor", more))
    ours, theirs = table(place / "own-fluid" / "history.csv"), table(place / "runs" / "floor-own" / "history.csv")
    expect(len(ours) == len(theirs) == 11, f"--into: a row for each window: {len(ours) - 1}")
    shared = [name for name in ours[0] if name in theirs[0]]
    column = lambda rows, name: [row[rows[0].index(name)] for row in rows[1:]]
    wrong = [name for name in shared if column(ours, name) != column(theirs, name)]
    expect(len(shared) > 8 and not wrong, f"--into: {len(shared)} columns as in a run of Strake: {wrong}")
    for side in ("fluid", "structure"):
        frames = sorted(path.name for path in (place / f"own-{side}" / "frames").glob("*.h5"))
        expect(len(frames) == 3, f"--into: frames at 0, 2.5 and 5 ms: {frames}")
        log = (place / "runs" / "floor-into" / f"{side}.log").read_text()
        expect("the preCICE run has ended: 10 windows" in log and f"results in own-{side}" in log, f"{side}: its last word")
    refused(place, words_of("floor", "fluid", "--into", "own-fluid", "--precice-library", LIBRARY / "libprecice.so.3"), 4, "STRAKE_CONNECT")


def faults(place):
    """A participant that is killed is named within a second; a coupler that is killed leaves none behind."""
    for side in ("fluid", "structure"):
        words = [BIN / "strake", "run", "floor.toml", "--force", "--tag", side, "--set", "end_time=100", *precice_sets("floor")]
        shutil.rmtree(place / "runs" / f"floor-{side}", ignore_errors=True)
        process = subprocess.Popen(list(map(str, words)), cwd=place, env=ENV, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        expect(wait_until(lambda: rows(place / "runs" / f"floor-{side}") >= 3, 20), "the run is under way")
        solvers = children(process.pid)
        name = "strake-fluid" if side == "fluid" else "strake-structure-fem"
        os.kill(solvers[name], signal.SIGKILL)
        began = time.monotonic()
        errors = process.communicate(timeout=20)[1]
        took = time.monotonic() - began
        expect(process.returncode == 5 and errors.startswith(side) and "signal 9" in errors and took < 1.5,
               f"kill -9 of the {side}: exit {process.returncode} after {took:.2f} s: {errors.splitlines()[:1]}")
        expect(wait_until(lambda: not any(map(alive, solvers.values())), 1.5), "its partner has ended")
    shutil.rmtree(place / "runs" / "floor-hand", ignore_errors=True)
    words = [BIN / "strake", "run", "floor.toml", "--tag", "hand", "--attach", "both", "--set", "end_time=100", *precice_sets("floor")]
    coupler = subprocess.Popen(list(map(str, words)), cwd=place, env=ENV, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    record_file = place / "runs" / "floor-hand" / "run.json"
    by_hand = lambda: json.loads(record_file.read_text()).get("participants", {}) if record_file.exists() else {}
    expect(wait_until(lambda: all("start_by_hand" in by_hand().get(side, {}) for side in ("fluid", "structure")), 20), "run.json says how to start both by hand")
    hands = [subprocess.Popen(["bash", "-c", by_hand()[side]["start_by_hand"]], cwd=place, env=ENV, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
             for side in ("fluid", "structure")]
    expect(wait_until(lambda: rows(place / "runs" / "floor-hand") >= 3, 20), "the run is under way, both started by hand")
    coupler.kill()
    coupler.wait()
    began = time.monotonic()
    for side, process in zip(("fluid", "structure"), hands):
        errors = process.communicate(timeout=20)[1]
        took = time.monotonic() - began
        expect(process.returncode == 5 and "the coupler is gone" in errors and took < 2, f"kill -9 of the coupler: the {side} ends with {process.returncode} after {took:.2f} s: {errors.splitlines()[-1:]}")


def failing(place):
    """An error of the solver itself ends the run, and stands in its log."""
    more = lambda side: ("--set", "fluid.tank=[[-0.5, -0.3, 0.0], [0.5, 0.6, 0.0]]", "--set", "fluid.scheme.pressure.max_iterations=1") if side == "fluid" else ()
    result = subprocess.run([BIN / "strake", "run", "floor.toml", "--force", "--tag", "failing", *precice_sets("floor", more)],
                            cwd=place, env=ENV, capture_output=True, text=True, timeout=60)
    log = (place / "runs" / "floor-failing" / "fluid.log").read_text()
    expect(result.returncode == 4 and result.stderr.startswith("fluid, window 1") and "the pressure equation did not converge" in result.stderr
           and "fix: reduce fluid.scheme.time_step" in result.stderr, f"a solver that gives up: exit {result.returncode}: {result.stderr.splitlines()[:1]}")
    expect("pressure" in log, f"its log has the error: {log.splitlines()[-2:]}")


with folder() as place:
    place = pathlib.Path(place)
    for file in CASES.iterdir():
        shutil.copy(file, place)
    for case in NAMES:
        same_run(place, case)
    for check in (with_samples, wrong_inputs, other_library, surface_file, results, failing, faults):
        check(place)
finish()
