"""Texts from a case, a participant or a table. None moves the cursor of a terminal, and none ends a program."""
import csv
import json
import shutil

from processes import *  # noqa: F403: the test's own vocabulary

BAD = "\x1b]0;owned\x07\x1b[2J\u009b2J"
IN_TOML = r"\u001b]0;owned\u0007\u001b[2J\u009b2J"
RAW = ROOT / "tests" / "system" / "raw"
SHOWN = r"\x1b]0;owned\x07\x1b[2J\x9b2J"


def clean(text):
    return not any((ord(c) < 32 and c not in "\n\t") or 127 <= ord(c) < 160 for c in text)


def texts_of_a_case_and_of_a_participant(place):
    shutil.copytree(ROOT / "cases" / "python_spring", place / "case")
    case, solver = place / "case" / "python_spring.toml", place / "case" / "spring.py"
    case.write_text(case.read_text().replace("floor on a spring, in Python", "T" + IN_TOML).replace(
        "a mass on a spring: the column", "S" + IN_TOML).replace("end_time = 0.04353", "end_time = 0.005"))
    solver.write_text(solver.read_text().replace('lines = [f"spring ', f'lines = ["L" + {BAD!r}, f"spring '))
    for words in (["check"], ["run", "--tag", "a"], ["run", "--tag", "b", "--quiet"], ["run", "--tag", "c", "--json"]):
        result = strake(words[0], case, *words[1:], cwd=place)
        expect(result.returncode == 0, f"{words}: exit {result.returncode} {result.stderr}")
        expect(clean(result.stdout + result.stderr), f"{words}: no control character is printed")
        expect("--json" in words or "--quiet" in words or ("T" + SHOWN in result.stdout and "L" + SHOWN in result.stdout),
               f"{words}: they are shown as text")
    run = place / "runs" / "python_spring-a"
    expect(clean((run / "coupler.log").read_text()), "nor does one stand in the log")
    for words in (("watch", run), ("compare", run)):
        result = strake(*words, cwd=place)
        expect(clean(result.stdout + result.stderr), f"{words[0]}: no control character is printed")
    strake("report", run, cwd=place)
    page = (run / "report.html").read_text()
    expect("\x1b" not in page and "\x07" not in page, "nor does one stand in the report")
    solver.write_text(solver.read_text().replace("def advance(self, t, dt, load):",
                                                 f'def advance(self, t, dt, load):\n        raise strake.Error("P" + {BAD!r}, where="x")'))
    result = strake("run", case, "--tag", "fault", cwd=place)
    expect("P" + SHOWN in result.stderr and clean(result.stdout + result.stderr), f"a fault of a participant is shown as text\n{result.stderr!r}")
    expect(clean((place / "runs" / "python_spring-fault" / "coupler.log").read_text()), "and so it stands in the log")


def texts_of_a_table(place):
    for name in ("a.csv", "b.csv"):
        (place / name).write_text(f"time [s],x\x1b\x07 [m]\n0,0\n0.5,1\n1,0\n")
    result = strake("compare", "a.csv", "b.csv", cwd=place)
    expect(r"x\x1b\x07 [m]" in result.stdout and clean(result.stdout + result.stderr), "compare: a column's name is shown as text")


def bytes_that_are_no_text(place):
    process = subprocess.run([str(BIN / "strake").encode(), b"run", str(ROOT / "cases" / "still_tank.toml").encode(), b"--set",
                              b"end_time=0.01", b"--tag", b"\xff\x1b"], cwd=place, env=ENV, capture_output=True, timeout=60)
    expect(process.returncode == 2 and b"\\xff\\x1b: expected a name" in process.stderr and b"\x1b" not in process.stderr,
           f"a tag that is no text: exit {process.returncode} {process.stderr!r}")


def very_deep(place):
    n = 50_000
    plain = (ROOT / "cases" / "still_tank.toml").read_text()
    for what, text in (("a table's name", "[a" + ".a" * n + "]\n"), ("a dotted key", "a" + ".a" * n + " = 1\n"),
                       ("lists", "a = " + "[" * n + "]" * n + "\n"), ("tables in lists", "a = " + "[{a.a=" * n + "1" + "}]" * n + "\n")):
        (place / "deep.toml").write_text(plain + text if text[0] == "[" else text + plain)
        line = plain.count("\n") + 1 if text[0] == "[" else 1
        result = strake("check", "deep.toml", cwd=place, timeout=20)
        expect(result.returncode == 3 and f"deep.toml:{line}" in result.stderr, f"{what} of 50 000 levels: exit {result.returncode} {result.stderr[:120]!r}")
    for what, text in (("key", "a" + ".a" * n + "=1"), ("value", "a=" + "[" * n + "]" * n)):
        result = strake("check", ROOT / "cases" / "still_tank.toml", "--set", text, cwd=place, timeout=20)
        expect(result.returncode == 3 and "--set" in result.stderr and len(result.stderr) < 2000, f"--set with such a {what}: exit {result.returncode}")


def what_a_participant_says_of_itself(place):
    twice = 'name="floor.y", unit="m")'  # the package cannot say it: a solver that speaks the messages itself
    for name, raw, old, new in (("twice", True, twice, f"{twice}, pb.Column({twice}"),
                                ("limit", False, "self.columns =", "self.dt_limit = 1e-4; self.columns =")):
        shutil.copytree(ROOT / "cases" / "python_spring", place / name)
        if raw:
            shutil.copytree(RAW, place / name, dirs_exist_ok=True)
        solver = place / name / "spring.py"
        assert old in solver.read_text()
        solver.write_text(solver.read_text().replace(old, new))
    words = ("--set", "end_time=1e-3")
    result = strake("run", place / "twice" / "python_spring.toml", *words, "--tag", "twice", cwd=place)
    expect(result.returncode == 5 and "gives the column floor.y twice" in result.stderr, f"a column named twice: exit {result.returncode}\n{result.stderr}")
    result = strake("run", place / "limit" / "python_spring.toml", *words, "--tag", "limit", cwd=place)
    with open(place / "runs" / "python_spring-limit" / "history.csv", newline="") as file:
        times = [float(row["time [s]"]) for row in csv.DictReader(file)]
    expect(all(abs(time - k * 2.5e-4 / 3) < 1e-9 for k, time in enumerate(times[:3], 1)),
           f"no window is longer than its participant accepts: {times[:3]}")


with folder() as name:
    here = pathlib.Path(name)
    texts_of_a_case_and_of_a_participant(here)
    texts_of_a_table(here)
    bytes_that_are_no_text(here)
    very_deep(here)
    what_a_participant_says_of_itself(here)
finish()
