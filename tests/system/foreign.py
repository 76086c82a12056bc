"""Solvers that are not ours: one in C++ against the installed package, built outside the tree, and two in Python, one by
the package `strake` and one that speaks the messages itself. All are the floor on a spring of cases/python_spring, run by the
installed programs, so they must agree."""
import csv
import json
import re
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
    for component in ("programs", "cases", "python", "participant"):
        command("cmake", "--install", BUILD, "--prefix", prefix, "--component", component, cwd=place)
    pages = prefix / "share" / "man" / "man1"
    expect({"strake.1", "strake-run.1", "strake-fluid.1"} <= {page.name for page in pages.glob("*.1")}, f"man pages are installed in {pages}")
    completion = prefix / "share" / "bash-completion" / "completions" / "strake"
    expect(completion.exists() and "strake-structure-ccx" in completion.read_text().splitlines()[-1].split(), f"the completion is {completion}")
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


def python_package(place, prefix):
    """The package of the installation finds its program, its messages and its version."""
    code = "import strake; from strake.programs import find_program; import strake.messages; print(strake.__version__, find_program())"
    folders = f"{prefix}/share/strake/python:{prefix}/share/strake/python_precice"
    result = subprocess.run(["/usr/bin/python3", "-B", "-c", code + "; import precice; print(precice.__file__)"], cwd=place,
                            env=dict(ENV, PYTHONPATH=folders, STRAKE_BIN=""), capture_output=True, text=True)
    words = result.stdout.split()
    expect(len(words) == 3 and re.fullmatch(r"\d+\.\d+\.\d+", words[0]) and words[1] == f"{prefix}/bin/strake" and str(prefix) in words[2],
           f"the installed package: {result.stdout.strip() or result.stderr}")


def cases_by_name(place, prefix):
    """The installed programs find Strake's cases by their names, from any folder; a file of one's own comes first."""
    words, elsewhere = [prefix / "bin" / "strake"], place / "elsewhere"
    elsewhere.mkdir()
    told = command(*words, "run", "cantilever", "--strict", cwd=elsewhere).stdout
    record = json.loads((elsewhere / "runs" / "cantilever" / "run.json").read_text())
    expect("pass" in told and record["case"] == f"{prefix}/share/strake/cases/cantilever.toml", f"cantilever is {record['case']}")
    listed = command(*words, "study", "study_plate", "--list", cwd=elsewhere).stdout
    expect("/share/strake/cases/plate_entry.toml" in listed, "study_plate is found, and its case")
    checked = command(*words, "check", "python_spring", cwd=elsewhere).stdout
    expect("python_spring/python_spring.toml: nothing to refuse" in checked, "a case with a program beside it is found")
    expect(os.access(prefix / "share/strake/cases/python_spring/spring.py", os.X_OK), "that program can be executed")
    shutil.copy(prefix / "share/strake/cases/cantilever.toml", elsewhere / "still_tank.toml")
    expect("\nstill_tank.toml: nothing" in command(*words, "check", "still_tank", cwd=elsewhere).stdout, "a file in the current folder comes first")
    for name, advice in (("plate_entri", "did you mean plate_entry?"), ("qqqqqq", "one of box_entry, ")):
        refused = subprocess.run([*words, "run", name], cwd=elsewhere, env=ENV, capture_output=True, text=True)
        expect(refused.returncode == 3 and f"no file {name}.toml here, and no case of that name in {prefix}/share" in refused.stderr
               and advice in refused.stderr, f"{name}: exit {refused.returncode}, {advice}")
    installed = {path.stem for path in (prefix / "share/strake/cases").rglob("*.toml")}
    expect(installed == {path.stem for path in (ROOT / "cases").rglob("*.toml")}, f"all {len(installed)} cases are installed")


def run_both(place, prefix, solver):
    case = place / "case"
    shutil.copytree(CASE, case)
    expect(len((case / "spring.py").read_text().splitlines()) <= 25, "the solver in Python has at most 25 lines")
    words = [prefix / "bin" / "strake", "run", case / "python_spring.toml"]
    command(*words, "--strict", cwd=place)
    command(*words, "--tag", "cpp", "--set", f"structure.solver={solver}", cwd=place)
    runs = place / "runs" / "python_spring", place / "runs" / "python_spring-cpp"
    raw = place / "raw"
    shutil.copytree(CASE, raw)
    shutil.copytree(FOREIGN.parent / "raw", raw, dirs_exist_ok=True)
    command(*words[:2], raw / "python_spring.toml", "--tag", "raw", cwd=place)
    for name in ("history.csv", "iterations.csv"):
        expect((place / "runs" / "python_spring-raw" / name).read_bytes() == (runs[0] / name).read_bytes(),
               f"package and raw messages: {name} is the same to the byte")
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


def changed_spring(place, name, *changes):
    """The solver that speaks the messages itself, with other words in it."""
    text = (FOREIGN.parent / "raw" / "spring.py").read_text()
    shutil.copy(FOREIGN.parent / "raw" / "connection.py", place / "case")
    for was, now in changes:
        expect(text.count(was) == 1, f"{name}: spring.py has {was!r} once")
        text = text.replace(was, now)
    (place / "case" / name).write_text(text)
    (place / "case" / name).chmod(0o755)
    return ["--set", f"structure.solver=./{name}"]


def run_that_cannot_resume(place, words):
    own = changed_spring(place, "forgetful", ("dt_limit=np.inf, columns", "dt_limit=np.inf, cannot_resume=True, columns"))
    says = "structure cannot save its state"
    checked = command(words[0], "check", *words[2:], *own, cwd=place).stdout
    expect(checked.count(says) == 1, "forgetful: check says once that the structure cannot save its state")
    process, run = begin(place, words, "forgetful", *own, "--set", "run.checkpoint_windows=10")
    expect(wait_until(lambda: rows(run) >= 50, 60), "forgetful: the run is under way")
    process.send_signal(signal.SIGINT)
    output = process.communicate(timeout=30)[0]
    expect(process.returncode == 130 and f"nothing to go on from: {says}" in output, f"forgetful: interrupted, and told: exit {process.returncode}")
    expect(output.count("--resume cannot go on with it") == 1, "forgetful: the run says it once")
    expect(not (run / "checkpoint").exists(), "forgetful: no checkpoint was written")
    again = subprocess.run([*map(str, words), "--tag", "forgetful", *own, "--resume"], cwd=place, env=ENV, capture_output=True, text=True)
    expect(again.returncode == 2 and f"cannot be resumed: {says}" in again.stderr, f"forgetful: --resume is refused, exit {again.returncode}")


def run_with_faces_from_a_file(place, words, whole):
    """A structure that sends its points alone, as most programs do that were written for another coupler."""
    own = changed_spring(place, "faceless", ("n_points=2 * n, n_faces=2 * n)", "n_points=2 * n)"),
                         ('frames = position.astype("<f8"), faces.astype("<i4"),', 'frames = position.astype("<f8"),'))
    refused = subprocess.run([*map(str, words), "--tag", "faceless", *own], cwd=place, env=ENV, capture_output=True, text=True)
    expect(refused.returncode == 3 and "has points but no faces" in refused.stderr and "structure.surface" in refused.stderr,
           f"faceless: the advice names structure.surface, exit {refused.returncode}\n{refused.stderr if refused.returncode != 3 else ''}")
    n = 21
    points = [(-0.5 + i / (n - 1), -0.05) for i in range(n)] + [(0.5 - i / (n - 1), 0.0) for i in range(n)]
    nodes = "".join(f"{k + 1} {x:.17g} {y:.17g} 0\n" for k, (x, y) in enumerate(points))
    lines = "".join(f"{k + 1} 1 2 0 1 {a} {b}\n" for k, (a, b) in
                    enumerate((k + 1, (k + 1) % (2 * n) + 1) if k % 3 else ((k + 1) % (2 * n) + 1, k + 1) for k in range(2 * n)))
    (place / "case" / "floor.msh").write_text(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{2 * n}\n{nodes}$EndNodes\n"
                                              f"$Elements\n{2 * n}\n{lines}$EndElements\n")
    told = command(*words, "--tag", "faceless", *own, "--set", "structure.surface=floor.msh", cwd=place).stdout
    expect("42 faces from floor.msh" in told, "faceless: the run says where the faces come from")
    twice = subprocess.run([*map(str, words), "--tag", "twice", "--set", "structure.surface=floor.msh"], cwd=place, env=ENV, capture_output=True, text=True)
    expect(twice.returncode == 3 and "the structure sends 42 faces itself" in twice.stderr, "faceless: a surface beside faces is refused")
    expect((place / "runs" / "python_spring-faceless" / "history.csv").read_bytes() == (whole / "history.csv").read_bytes(),
           "faceless: with faces from a file, history.csv is the same to the byte")


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
    python_package(place, prefix)
    cases_by_name(place, prefix)
    words, whole = run_both(place, prefix, solver)
    run_without_options(place, words, whole)
    run_that_cannot_resume(place, words)
    run_with_faces_from_a_file(place, words, whole)
    resume_python(place, words, whole)
    coupler_dies(place, words)
    solver_is_suspended(place, words, whole)
    solver_started_by_hand_ends_with_the_coupler(place, words)
finish()
