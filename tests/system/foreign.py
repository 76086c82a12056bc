"""Solvers that are not ours: one in C++ against the installed package, built outside the tree, and one in Python.
Both are the floor on a spring of cases/python_spring, run by the installed programs, so they must agree."""
import csv
import json
import shutil
import time
import tomllib

from processes import *  # noqa: F403: the test's own vocabulary

BUILD = BIN.parent
CASE = ROOT / "cases" / "python_spring"
FOREIGN = ROOT / "tests" / "system" / "foreign"


def command(*words, cwd, timeout=300):
    result = subprocess.run(list(map(str, words)), cwd=cwd, env=ENV, capture_output=True, text=True, timeout=timeout)
    expect(result.returncode == 0, f"{' '.join(map(str, words))[:100]}: exit {result.returncode}"
           + ("\n" + result.stdout + result.stderr if result.returncode else ""))
    return result


def column(run, name):
    with open(run / "history.csv", newline="") as file:
        return [float(row[name]) for row in csv.DictReader(file)]


def build_outside(place, prefix):
    for component in ("programs", "participant"):
        command("cmake", "--install", BUILD, "--prefix", prefix, "--component", component, cwd=place)
    source = place / "solver"
    shutil.copytree(FOREIGN, source)
    expect(len((source / "spring.cpp").read_text().splitlines()) < 50, "the solver in C++ is short")
    command("cmake", "-S", source, "-B", place / "made", f"-DCMAKE_PREFIX_PATH={prefix}", "-DCMAKE_BUILD_TYPE=Release", cwd=place)
    command("cmake", "--build", place / "made", cwd=place)
    for file in (prefix / "include" / "strake").rglob("*.hpp"):
        for line in file.read_text().splitlines():
            if line.startswith('#include "'):
                expect((prefix / "include" / "strake" / line.split('"')[1]).exists(), f"{file.name}: {line} is installed")
    keys = json.loads(command(place / "made" / "spring", "--keys", cwd=place).stdout)
    expect(any(key["path"] == "structure.spring.mass" for key in keys), "the solver prints its keys")
    return place / "made" / "spring"


def run_both(place, prefix, solver):
    case = place / "case"
    shutil.copytree(CASE, case)
    expect(len((case / "spring.py").read_text().splitlines()) <= 60, "the solver in Python has at most 60 lines")
    words = [prefix / "bin" / "strake", "run", case / "python_spring.toml"]
    command(*words, "--strict", cwd=place)
    command(*words, "--tag", "cpp", "--set", f"structure.solver={solver}", cwd=place)
    runs = place / "runs" / "python_spring", place / "runs" / "python_spring-cpp"
    y = [column(run, "floor.y [m]") for run in runs]
    largest = max(map(abs, y[0]))
    gap = max(abs(a - b) for a, b in zip(*y)) / largest
    expect(len(y[0]) == len(y[1]) == 175 and gap < 1e-6, f"Python and C++ move the floor alike: {len(y[0])} windows, gap {gap:.1e}")
    for verdict in json.loads((runs[0] / "summary.json").read_text())["compare"]:
        print(f"      {verdict['probe']} {verdict['metric']} {verdict['value']:.5g}, theory {verdict['reference']:.5g}")
    heavy = command(*words, "--tag", "heavy", "--set", "structure.spring.mass=1000", "--set", "end_time=0.005", cwd=place)
    expect("m 1000 kg" in heavy.stdout, "--set reaches the solver's own table")
    resolved = tomllib.loads((place / "runs" / "python_spring-heavy" / "case.toml").read_text())["structure"]
    expect(float(resolved["spring"]["mass"]) == 1000 and resolved["spring"]["stiffness"] == 1e8
           and resolved["solver"] == str(case / "spring.py"), "the resolved case keeps the solver's own table")
    return words, runs[0]


UNMODIFIED = """#!/usr/bin/python3 -B
import os, runpy, sys
assert sys.argv[1:] == ["-i", "floor"], sys.argv
assert os.getcwd() == os.path.realpath(os.path.dirname(sys.argv[0]) + "/elsewhere"), os.getcwd()
case = "../python_spring.toml"  # of its own knowledge: no option names it
sys.argv = ["spring.py", "--connect", os.environ["STRAKE_CONNECT"], "--name", os.environ["STRAKE_NAME"],
            "--case-hash", os.environ["STRAKE_CASE_HASH"], "--case", case]
sys.path.insert(0, "..")
runpy.run_path("../spring.py", run_name="__main__")
"""


def run_without_options(place, words, whole):
    """A program whose command line takes none of Strake's options: its connection is in its environment."""
    case = place / "case"
    (case / "elsewhere").mkdir()
    (case / "unmodified").write_text(UNMODIFIED)
    (case / "unmodified").chmod(0o755)
    own = ["--set", "structure.solver=./unmodified", "--set", 'structure.arguments=["-i", "floor"]', "--set", "structure.folder=elsewhere"]
    command(*words, "--tag", "plain", *own, cwd=place)
    run = place / "runs" / "python_spring-plain"
    expect((run / "history.csv").read_bytes() == (whole / "history.csv").read_bytes(), "no options: history.csv is the same to the byte")
    refused = subprocess.run([*map(str, words), "--tag", "fem", "--set", "structure.solver=rigid", "--set", "structure.arguments=[]"],
                             cwd=place, env=ENV, capture_output=True, text=True)
    expect(refused.returncode == 3 and 'no such key beside solver = "rigid"' in refused.stderr,
           f"no options: arguments for a solver of ours are refused, exit {refused.returncode}")


def resume_python(place, words, whole):
    cut = place / "runs" / "python_spring-cut"
    process = subprocess.Popen([*map(str, words), "--tag", "cut"], cwd=place, env=ENV, stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, text=True)
    expect(wait_until(lambda: rows(cut) >= 50, 60), "resume: the run is under way")
    process.send_signal(signal.SIGINT)
    errors = process.communicate(timeout=30)[1]
    expect(process.returncode == 130, f"resume: interrupted with {process.returncode}\n{errors}")
    command(*words, "--tag", "cut", "--resume", cwd=place)
    for name in ("history.csv", "iterations.csv"):
        expect((cut / name).read_bytes() == (whole / name).read_bytes(), f"resume: {name} of the Python solver is the same to the byte")


def coupler_dies(place, words):
    process = subprocess.Popen([*map(str, words), "--tag", "killed"], cwd=place, env=ENV, stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
    killed = place / "runs" / "python_spring-killed"
    expect(wait_until(lambda: rows(killed) >= 5, 60), "kill: the run is under way")
    solvers = children(process.pid)
    process.kill()
    process.wait()
    expect(len(solvers) == 2, f"kill: two solvers were running: {sorted(solvers)}")
    expect(wait_until(lambda: not any(alive(pid) for pid in solvers.values()), 5), "kill: no solver outlives the coupler")


def begin(place, words, tag, *more):
    process = subprocess.Popen([*map(str, words), "--tag", tag, *more], cwd=place, env=ENV, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, text=True)
    return process, place / "runs" / f"python_spring-{tag}"


def solver_is_suspended(place, words, whole):
    """Longer than the heartbeats allow: the coupler cuts the connection, and the solver makes a new one."""
    process, run = begin(place, words, "nap")
    expect(wait_until(lambda: rows(run) >= 20, 60), "suspended: the run is under way")
    solver = children(process.pid)["python3"]
    os.kill(solver, signal.SIGSTOP)
    time.sleep(1.5)
    os.kill(solver, signal.SIGCONT)
    output = process.communicate(timeout=60)[0]
    expect(process.returncode == 0, f"suspended: the run goes on, exit {process.returncode}" + (output if process.returncode else ""))
    for name in ("history.csv", "iterations.csv"):
        expect((run / name).read_bytes() == (whole / name).read_bytes(), f"suspended: {name} is the same to the byte")


def solver_started_by_hand_ends_with_the_coupler(place, words):
    process, run = begin(place, words, "hand", "--attach", "structure")
    record = run / "run.json"
    expect(wait_until(lambda: record.exists() and "start_by_hand" in record.read_text(), 30), "by hand: its command line is told")
    line = json.loads(record.read_text())["participants"]["structure"]["start_by_hand"]
    solver = subprocess.Popen(["bash", "-c", f"exec env {line}"], cwd=place, env=ENV, stderr=subprocess.PIPE, text=True)
    expect(wait_until(lambda: rows(run) >= 5, 60), "by hand: the run is under way")
    process.kill()
    process.communicate()
    killed = time.monotonic()
    try:
        errors = solver.communicate(timeout=20)[1]
    except subprocess.TimeoutExpired:
        solver.kill()
        errors = solver.communicate()[1]
    took = time.monotonic() - killed
    expect(took < 5 and solver.returncode == 5, f"by hand: it ends {took:.1f} s after the coupler, exit {solver.returncode}: {errors}")


with folder() as place:
    place = pathlib.Path(place)
    prefix = place / "prefix"
    solver = build_outside(place, prefix)
    words, whole = run_both(place, prefix, solver)
    run_without_options(place, words, whole)
    resume_python(place, words, whole)
    coupler_dies(place, words)
    solver_is_suspended(place, words, whole)
    solver_started_by_hand_ends_with_the_coupler(place, words)
finish()
