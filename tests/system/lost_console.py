"""Commands whose output cannot be written: a full disk, a closed stream, a reader that leaves. Also places that the system
cannot inspect."""
import json

from processes import *  # noqa: F403: the test's own vocabulary

CASE = ROOT / "cases" / "still_tank.toml"
SHORT = ["--set", "end_time=0.05"]
STUDY = f'title = "one"\ncase = "{CASE}"\n[[axis]]\nname = "g"\n[[axis.value]]\nlabel = "a"\nset = ["end_time=0.05"]\n'


def in_shell(words, redirection, cwd):
    line = f'exec "{BIN / "strake"}" {words} {redirection}'
    return subprocess.run(["bash", "-c", line], cwd=cwd, env=ENV, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, timeout=120)


def of_every_command(place):
    (place / "one.toml").write_text(STUDY)
    (place / "a.csv").write_text("time [s],x [m]\n0,0\n0.5,1\n1,0\n")
    case = f'"{CASE}" {" ".join(SHORT)}'
    for redirection in (">/dev/full", ">&-"):
        for k, words in enumerate(("explain", f"check {case}", "compare a.csv a.csv", "study one.toml --list", f"run {case}")):
            result = in_shell(words + (f" --tag {len(redirection)}" if words.startswith("run") else ""), redirection, place)
            expect(result.returncode == 6 and "standard output: cannot be written" in result.stderr and "bug" not in result.stderr,
                   f"{words.split()[0]} {redirection}: exit {result.returncode}, {result.stderr.strip()[:150]!r}")


def of_a_run(place):
    for run in sorted((place / "runs").glob("still_tank-*")):
        expect(json.loads((run / "run.json").read_text())["exit_code"] == 0, f"{run.name}: the run itself is whole")
        log = (run / "coupler.log").read_text()
        expect("the run goes on without it" in log, f"{run.name}: the log says that the console was lost")
        for file in (f for f in run.rglob("*") if f.is_file() and f.suffix in (".csv", ".json", ".toml", ".log")):
            expect("open in ParaView" not in file.read_text(), f"{run.name}: no line of the console stands in {file.name}")


def whose_reader_leaves(place):
    process = start("run", CASE, "--set", "end_time=0.3", "--tag", "head", cwd=place)
    try:
        first = process.stdout.readline()
        process.stdout.close()
        process.wait(timeout=60)
        run = place / "runs" / "still_tank-head"
        record = json.loads((run / "run.json").read_text())
        expect(first != "" and process.returncode == 0 and record["exit_code"] == 0,
               f"strake run | head -1: exit {process.returncode}, run.json {record['exit_code']}")
        expect("the console cannot be written (Broken pipe); the run goes on" in (run / "coupler.log").read_text(),
               "the log says that the pipe was closed")
        expect("Broken" not in process.stderr.read(), "and nothing else does")
    finally:
        end(process)
    line = f'"{BIN / "strake"}" explain --markdown | head -1; exit ${{PIPESTATUS[0]}}'
    result = subprocess.run(["bash", "-c", line], cwd=place, env=ENV, capture_output=True, text=True, timeout=30)
    expect(result.returncode in (0, 141) and result.stderr == "", f"strake explain | head -1: exit {result.returncode} {result.stderr!r}")


def places_that_cannot_be_looked_at(place):
    (place / "round").symlink_to(place / "about")
    (place / "about").symlink_to(place / "round")
    for words, codes in ((("run", CASE, "--runs", "round"), (2, 6)), (("run", CASE, "--tag", "x" * 300), (2,)),
                         (("run", CASE, "--runs", "x" * 300), (2, 6)), (("compare", "round"), (3,)), (("report", "round"), (3,)),
                         (("export", "round", "--to", "ccx"), (3,)), (("picture", "round"), (2, 3)), (("watch", "round"), (2, 3)),
                         (("study", "round"), (2, 3)), (("keys", "round"), (2, 6)), (("check", "round"), (3,)),
                         (("replay", "round", "--onto", CASE), (3,))):
        result = strake(*words, cwd=place)
        expect(result.returncode in codes and "bug" not in result.stderr,
               f"{words[0]} {str(words[-1])[:20]}: exit {result.returncode}, {result.stderr.strip()[:120]!r}")


with folder() as name:
    here = pathlib.Path(name)
    of_every_command(here)
    of_a_run(here)
    whose_reader_leaves(here)
    places_that_cannot_be_looked_at(here)
finish()
