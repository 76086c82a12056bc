"""The commands as a user types them: their output, their files, and a second call."""
import json
import re
import shutil

from processes import *  # noqa: F403: the test's own vocabulary

CASE = ROOT / "cases" / "plate_entry.toml"
QUICK = ["--set", "structure.solver=rigid", "--set", "fluid.scheme.time_step=1e-5"]
SUMMARY = {"case", "tag", "exit_code", "end_time", "windows", "iterations", "particles", "steps", "steps_committed",
           "seconds", "ranks", "peak_memory_bytes", "probes", "checks", "alarms", "resolution", "compare", "failure"}


def equal(one, other, what, names=("history.csv", "iterations.csv")):
    for name in names:
        expect((one / name).read_bytes() == (other / name).read_bytes(), f"{what}: {name} is the same to the byte")
    for part in ("frames", "interface"):
        files = {f.name for f in (one / part).iterdir()}
        expect(files == {f.name for f in (other / part).iterdir()}, f"{what}: the same files in {part}/")
        same = all((one / part / f).read_bytes() == (other / part / f).read_bytes() for f in files)
        expect(same, f"{what}: {part}/ is the same to the byte ({len(files)} files)")


def help_and_version(place):
    result = strake("--help", cwd=place)
    expect(result.returncode == 0, "--help exits 0")
    for command in ("run", "check", "new", "explain", "compare", "replay", "export", "picture", "film", "report", "study", "watch", "manual"):
        expect(f"  {command} " in result.stdout, f"--help names {command}")
    for words, meant in ((("rnu", "x.toml"), "run"), (("chekc",), "check"), (("run", "x.toml", "--tga", "a"), "--tag"),
                         (("compare", "a", "--porbe=mid.y"), "--probe")):
        wrong = strake(*words, cwd=place)
        expect(wrong.returncode == 2 and f"did you mean {meant}?" in wrong.stderr, f"{' '.join(words)}: {wrong.stderr.strip()}")
    other = strake("gallop", cwd=place)
    expect(other.returncode == 2 and '"gallop" is no command' in other.stderr, f"an unknown command: {other.stderr.strip()}")
    for words, said in ((("case.toml",), "fix: strake run case.toml"), (("run", "x.toml", "--tag", "a", "--tag", "b"), "--tag is given 2 times")):
        wrong = strake(*words, cwd=place)
        expect(wrong.returncode == 2 and said in wrong.stderr, f"{' '.join(words)}: {wrong.stderr.strip()}")
    resumed = strake("resume", "plate_entry", cwd=place)
    expect(resumed.returncode == 2 and "strake run CASE --resume" in resumed.stderr, f"resume is an option of run: {resumed.stderr.strip()}")
    version = strake("--version", cwd=place)
    expect(version.returncode == 0 and version.stdout.startswith("strake "), f"--version: {version.stdout.strip()}")


def manual_is_found(place):
    programs = place / "build" / "bin"
    programs.mkdir(parents=True)
    shutil.copy(BIN / "strake", programs)

    def manual():
        return subprocess.run([programs / "strake", "manual"], capture_output=True, text=True, timeout=60)
    nowhere = manual()
    expect(nowhere.returncode == 2 and "fix:" in nowhere.stderr, f"manual without pages: exit {nowhere.returncode}\n{nowhere.stderr}")
    for name in ("README.md", "tests/run.sh", "fluid/THEORY.md", "build/share/doc/strake/html/index.html", "build/manual/index.html"):
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        (place / name).touch()
        if name.startswith("build/") or name == "fluid/THEORY.md":
            result = manual()
            first = result.stdout.partition("\n")[0]
            wanted = place / (name if name.startswith("build/") else "README.md")
            expect(result.returncode == 0 and first == str(wanted), f"manual says {first}, wanted {wanted}")
            expect(("--manual" in result.stdout) == (wanted.name == "README.md"), "manual names its command where it is not built")


def programs_are_asked_once(place):
    """Before a run a program is started once for all that it says of the case: a start of deal.II takes 0.35 s."""
    programs, starts = place / "bin", place / "starts"
    programs.mkdir()
    shutil.copy(BIN / "strake", programs)
    for name in ("strake-fluid", "strake-structure-rigid"):
        (programs / name).write_text(f'#!/bin/sh\necho {name} "$1" >> {starts}\nexec {BIN.resolve() / name} "$@"\n')
        (programs / name).chmod(0o755)
    case = ["--set", "structure.solver=rigid", "--set", "fluid.spacing=0.02", "--set", "end_time=1e-4"]
    done = subprocess.run([programs / "strake", "run", CASE, *case, "--runs", place], cwd=place, env=ENV, capture_output=True, text=True, timeout=60)
    expect(done.returncode == 0, f"a run with programs that count their starts: exit {done.returncode}\n{done.stderr}")
    for name in ("strake-fluid", "strake-structure-rigid"):
        asked = [line.split()[1] for line in starts.read_text().splitlines() if line.split()[0] == name]
        expect(asked == ["--check", "--connect"], f"{name} is started to be asked and to run: {asked}")
    starts.unlink()
    checked = subprocess.run([programs / "strake", "check", CASE, *case], cwd=place, env=ENV, capture_output=True, text=True, timeout=60)
    asked = [line.split()[1] for line in starts.read_text().splitlines() if line.split()[0] == "strake-structure-rigid"]
    expect(checked.returncode == 0 and asked == ["--check", "--connect"], f"check starts the structure's program to ask it and to set it up: {asked}")
    whole = strake("check", CASE, *case, cwd=place).stdout
    row = re.search(r"^rigid .*any$", checked.stdout, re.M)
    expect(row and row[0] in whole, f"and prints its line of the table: {row and row[0]}")


def check_leaves_nothing(place):
    result = strake("check", CASE, *QUICK, cwd=place)
    expect(result.returncode == 0, f"check: exit {result.returncode}\n{result.stderr}")
    expect("added-mass ratio" in result.stdout and "# default" not in result.stdout, "check prints derived values")
    head = result.stdout.split("  fluid  ")[0]
    expect("  steps " in head and "on one core" in head, "check says first how the run steps and what it costs")
    expect("Strake would take" not in result.stdout, "check finds no key far off in a case of ours")
    slow = strake("check", CASE, *QUICK, "--set", "coupling.surface.window=1e-3", cwd=place)
    expect("coupling.surface.window = 0.001 is 100 times what Strake would take" in slow.stdout, "check names a key that is far off")
    sunk = strake("check", CASE, *QUICK, "--set", "fluid.gravity=[-9.81,0]", "--set", "fluid.water=[[-1,-0.5],[1,0.1]]", cwd=place)
    expect(sunk.returncode == 3 and "overlaps the water" in sunk.stderr and "fluid.gravity points sideways" in sunk.stdout,
           f"check says what is odd of a case that is refused as well: exit {sunk.returncode}\n{sunk.stdout}{sunk.stderr}")
    every = strake("check", CASE, *QUICK, "--all", cwd=place)
    expect(every.returncode == 0 and "# default" in every.stdout, "check --all prints every value and its origin")
    for line in ("largest distance", "fluid points are not covered", "structure points feel no load", "rows sum to 1"):
        expect(line in result.stdout, f"check prints the mapping's quality: {line}")
    radial = strake("check", CASE, *QUICK, "--set", "coupling.surface.mapping.kind=radial-basis", cwd=place)
    expect(radial.returncode == 0 and re.search(r"condition \S+, the worst of \d+ systems", radial.stdout),
           f"check prints the condition of a radial basis\n{radial.stderr}")
    drawn = strake("check", CASE, *QUICK, "--picture", "x.png", cwd=place)
    expect(drawn.returncode == 2 and "x.svg" in drawn.stderr, f"check --picture refuses what it cannot draw\n{drawn.stderr}")
    expect(not any(place.iterdir()), "check leaves nothing behind")
    heavy = strake("check", CASE, *QUICK, "--set", "structure.mass=80", "--set", "structure.lumped.mass=20", cwd=place)
    expect("rho_s h  0.80\n" in heavy.stdout, "the added-mass ratio of a rigid plate, 1000 x 0.2 x 0.4 kg, is that to its 100 kg")
    explicit = strake("check", CASE, "--set", "structure.solver=particle", "--set",
                      "coupling.surface.converged.max_iterations=1", cwd=place)
    expect("warning" in explicit.stdout and "one coupling iteration" in explicit.stdout,
           "check warns of explicit surface coupling")


def run_and_judge(place):
    result = strake("run", CASE, *QUICK, "--set", "end_time=2.3e-3", cwd=place)
    run = place / "runs" / "plate_entry"
    expect(result.returncode == 0, f"run: exit {result.returncode}\n{result.stderr}")
    verdict = result.stdout.find("p_mid impulse")
    expect(0 < verdict < result.stdout.find("done  "), "the verdict is printed before the run ends")
    expect("\033" not in result.stdout and "\r" not in result.stdout, "a pipe gets plain lines")
    times = {side: re.findall(r'Time Value="([^"]*)"', (run / f"{side}.xdmf").read_text()) for side in ("fluid", "structure")}
    expect(times["fluid"] == times["structure"], f"both sides stamp a frame with one number {times}")
    expect(times["fluid"][0] == "0" and len(times["fluid"]) == 24, f"a frame at t = 0 and one each 0.1 ms {times['fluid']}")
    summary = json.loads((run / "summary.json").read_text())
    expect(set(summary) == SUMMARY, "summary.json has exactly its keys")
    expect(summary["windows"] == 230 and rows(run) == 230, "one row per window")
    record = json.loads((run / "run.json").read_text())
    expect(record["exit_code"] == 0 and record["endpoints"]["coupling"].startswith("ipc://"), "run.json is complete")
    for name in ("case.toml", "timing.csv", "fluid.log", "structure.log", "coupler.log", "fluid.xdmf", "structure.xdmf"):
        expect((run / name).exists(), f"{name} is there")
    expect(not pathlib.Path(record["endpoints"]["coupling"][6:]).parent.exists(), "the socket's folder is gone")
    again = strake("compare", run, cwd=place)
    expect([v["pass"] for v in summary["compare"]] == [line.startswith("pass") for line in again.stdout.splitlines()],
           f"compare says what the run said\n{again.stdout}")
    expect(again.returncode == (0 if all(v["pass"] for v in summary["compare"]) else 1), "compare's exit code is its verdict")
    repeated = strake("run", run / "case.toml", "--runs", "again", cwd=place)
    expect(repeated.returncode == 0, f"case.toml of a run is a case\n{repeated.stderr}")
    equal(run, place / "again" / "case", "the resolved case run again")
    return run


def compare_draws(place, run):
    for words, name in (((run,), "one.svg"), ((run, run), "two.png")):
        result = strake("compare", *words, "--probe", "p_mid", "--plot", name, cwd=place)
        drawn = (place / name).read_bytes() if (place / name).exists() else b""
        expect(drawn.startswith(b"\x89PNG") or b"<svg" in drawn[:200], f"compare --plot {name}: exit {result.returncode}\n{result.stderr}")
        expect(f"plot  {name}" in result.stdout, f"compare --plot {name} says what it wrote")
    alone = strake("compare", run, "--probe", "force.y", "--plot", "alone.svg", cwd=place)
    expect(alone.returncode == 0 and "<svg" in (place / "alone.svg").read_text()[:200],
           f"a quantity without a reference is drawn: exit {alone.returncode}\n{alone.stderr}")
    unknown = strake("compare", run, "--probe", "force", "--plot", "none.svg", cwd=place)
    expect(unknown.returncode == 3 and "did you mean force." in unknown.stderr, f"a quantity that is not recorded\n{unknown.stderr}")
    several = strake("compare", run, run, cwd=place)
    told = re.findall(r"^(\S+) \[.*\]   ", several.stdout, re.M)
    expect(told == ["force.y", "p_mid"] and "zero in all of them" in several.stdout and "--all" in several.stdout,
           f"compare of runs tells of probes and forces that are not zero: {told}")
    other = place / "renamed"
    shutil.copytree(run, other)
    (other / "history.csv").write_text((run / "history.csv").read_text().replace("p_mid", "p_low"))
    apart = strake("compare", run, other, cwd=place)
    expect("not in all of them: (1) has p_mid\n" in apart.stdout and "no probe or force is in all" not in apart.stdout,
           f"probes that not both have are named: {apart.stdout[-300:]}{apart.stderr}")
    found = json.loads((run / "summary.json").read_text())["probes"]["p_mid"]
    peak = re.search(r"p_mid.*?\n  peak +\[Pa\] +(\S+)", several.stdout, re.S)
    expect(peak and abs(float(peak.group(1)) / found["peak"] - 1) < 1e-5, f"their peaks are those of the steps: {peak and peak.group(1)}, {found['peak']}")
    everything = strake("compare", run, run, "--all", cwd=place)
    expect("\ncfl [1]" in everything.stdout and "\nmid.x [m]" in everything.stdout, "--all tells of every column")
    wrong = strake("compare", run, "--plot", "one.jpg", cwd=place)
    expect(wrong.returncode == 2 and ".svg" in wrong.stderr, f"compare --plot refuses other kinds\n{wrong.stderr}")


def strict_fails(place):
    text = CASE.read_text().replace("value = { impulse = 1583.0 }", "value = { impulse = 158.3 }")
    case = place / "strict.toml"
    case.write_text(text)
    words = ["run", case, *QUICK, "--set", "end_time=2.3e-3"]
    loose = strake(*words, cwd=place)
    expect(loose.returncode == 0 and "FAIL" in loose.stdout, "a failed block is said, and exit 0")
    strict = strake(*words, "--tag", "strict", "--strict", "--quiet", cwd=place)
    expect(strict.returncode == 1, f"--strict: exit {strict.returncode}")
    expect(strict.stdout.startswith("FAIL") and "window" not in strict.stdout, f"--quiet prints the verdicts alone\n{strict.stdout}")
    expect(strake("compare", place / "runs" / "strict", cwd=place).returncode == 1, "compare exits 1")


def resume_is_exact(place, run):
    words = ["run", CASE, *QUICK, "--set", "end_time=2.3e-3", "--tag", "cut"]
    cut = place / "runs" / "plate_entry-cut"
    process = start(*words, cwd=place)
    expect(wait_until(lambda: rows(cut) >= 100, 60), "resume: the run is under way")
    process.send_signal(signal.SIGINT)
    errors = process.communicate(timeout=30)[1]
    expect(process.returncode == 130 and "--resume" in errors, f"resume: interrupted with {process.returncode}")
    changed = strake(*words, "--resume", "--set", "fluid.spacing=0.02", cwd=place)
    expect(changed.returncode == 2 and "fluid.spacing" in changed.stderr, "resume: another case is refused")
    resumed = strake(*words, "--resume", cwd=place)
    expect(resumed.returncode == 0, f"resume: exit {resumed.returncode}\n{resumed.stderr}")
    equal(run, cut, "resume")


def resume_loses_nothing(place):
    words = ["run", CASE, *QUICK, "--set", "run.checkpoint_windows=20", "--tag", "kept"]
    run = place / "runs" / "plate_entry-kept"

    def contents():
        return {str(f.relative_to(run)): f.read_bytes() for f in run.rglob("*") if f.is_file() and f.suffix != ".log"}
    whole = strake(*words, "--set", "end_time=5e-4", cwd=place)
    expect(whole.returncode == 0 and rows(run) == 50, f"a run with checkpoints: exit {whole.returncode}")
    before = contents()
    for end in ("2e-4", "4.5e-4"):
        earlier = strake(*words, "--resume", "--set", f"end_time={end}", cwd=place)
        expect(earlier.returncode == 2 and "is computed to t = 0.0005 s" in earlier.stderr and "--tag" in earlier.stderr,
               f"--resume to an earlier end_time is refused: exit {earlier.returncode}\n{earlier.stderr}")
    expect(contents() == before, "a refused resume leaves every file as it was")
    later = strake(*words, "--resume", "--set", "end_time=6e-4", cwd=place)
    expect(later.returncode == 0 and rows(run) == 60, f"--resume to a later end_time: exit {later.returncode}\n{later.stderr}")


def replay_repeats(place, run):
    result = strake("replay", run, "--onto", CASE, *QUICK, "--set", "end_time=2.3e-3", cwd=place)
    expect(result.returncode == 0, f"replay: exit {result.returncode}\n{result.stderr}")
    column = (run / "history.csv").read_text().splitlines()[0].split(",").index("force.y [N/m]")
    forces = [[float(line.split(",")[column]) for line in (folder_ / "history.csv").read_text().splitlines()[1:]]
              for folder_ in (run, place / "runs" / "plate_entry-replay")]
    largest = max(abs(f) for f in forces[0])
    gap = max(abs(a - b) for a, b in zip(*forces)) / largest
    expect(len(forces[0]) == len(forces[1]) and gap < 1e-12, f"replay: the same force on the structure, gap {gap:.1e}")


def export_writes_decks(place, run):
    if not (BIN / "strake-structure-fem").exists():
        print("skip  export: there is no strake-structure-fem")
        return
    history = (run / "history.csv").read_text().splitlines()
    column = history[0].split(",").index("force.y [N/m]")
    impulse = sum(float(line.split(",")[column]) for line in history[1:]) * 1e-5
    for to, name, word in (("ccx", "ccx.inp", "*DYNAMIC, DIRECT, ALPHA=0."), ("ansys", "ansys.inp", "ANTYPE,TRANS")):
        result = strake("export", run, "--to", to, cwd=place)
        deck = run / "export" / name
        expect(result.returncode == 0 and deck.exists(), f"export --to {to}: exit {result.returncode}\n{result.stderr}")
        expect(word in deck.read_text() and "next" in result.stdout, f"export --to {to} is a transient analysis")
    felt, deck = 0.0, (run / "export" / "ccx.inp").read_text()
    for amplitude in re.findall(r"\*AMPLITUDE, NAME=F\d+Y,[^\n]*\n([^*]*)", deck):
        numbers = [float(n) for n in re.split(r"[,\s]+", amplitude.strip())]
        felt += sum((t1 - t0) * (a + b) / 2 for t0, a, t1, b in zip(numbers[::2], numbers[1::2], numbers[2::2], numbers[3::2]))
    # What falls on the clamped ends is lost to both.
    expect(0.9 < felt / impulse <= 1.0001, f"export: the deck carries the recorded impulse, {felt:.5g} of {impulse:.5g} N s/m")
    elsewhere = strake("export", run, "--to", "ccx", "-o", place / "decks", "--set", "structure.fem.refinement=1", cwd=place)
    expect(elsewhere.returncode == 0 and (place / "decks" / "probes.csv").exists(), f"export -o DIR\n{elsewhere.stderr}")
    page = strake("export", "--help", cwd=place).stdout
    expect("structure.analysis=modal" in page and "structure.solver" not in page, f"export --help names keys that a deck has\n{page}")
    modes = strake("export", run, "--to", "ccx", "-o", place / "modes", "--set", "structure.analysis=modal", cwd=place)
    expect(modes.returncode == 0 and "*FREQUENCY" in (place / "modes" / "ccx.inp").read_text(), f"a deck of modes\n{modes.stderr}")
    nowhere = strake("export", place, "--to", "ccx", cwd=place)
    expect(nowhere.returncode == 3 and "case.toml" in nowhere.stderr, f"export of no run is refused\n{nowhere.stderr}")
    for name, lines, words in (("outline", 'solver = "rigid"\noutline = [[0, 0], [1, 0], [0, 1]]', "structure.outline, which has no cells"),
                               ("none", 'solver = "none"', "has no structure"),
                               ("heavy", 'solver = "rigid"\nmass = 3.0\nplate = { length = 1.0, thickness = 0.1 }', '"rigid". With finite elements')):
        (place / name).mkdir(exist_ok=True)
        (place / name / "case.toml").write_text(f"[structure]\n{lines}\n")
        refused = strake("export", place / name, "--to", "ccx", cwd=place)
        expect(refused.returncode == 3 and words in refused.stderr and "--set structure.solver=fem" not in refused.stderr,
               f"export of {name} says what was found\n{refused.stderr}")
    other = strake("export", run, "--to", "ccx", "--set", "structure.plate.length=0.2", cwd=place)
    expect(other.returncode == 3 and "interface points" in other.stderr, f"export of another shape is refused\n{other.stderr}")


def full_disk(place):
    """A folder that cannot be written: as root only a full or read-only file system refuses."""
    result = strake("run", CASE, *QUICK, "--runs", "/proc/strake", cwd=place)
    expect(result.returncode == 6 and "fix:" in result.stderr, f"cannot write: exit {result.returncode}\n{result.stderr}")


def reference_of_keys():
    for typed, key in (("attachments[0].spring.anchor", "attachments[].spring.anchor"), ("structures[1].solver", "structure.solver")):
        told = strake("explain", typed, cwd=ROOT)
        expect(told.returncode == 0 and key in told.stdout, f"explain {typed}, as an error names it\n{told.stdout}{told.stderr}")
    result = strake("explain", "--markdown", cwd=ROOT)
    if result.stderr:
        print("skip  proto/CASE_FILE.md: " + result.stderr.strip())
        return
    page = (ROOT / "proto" / "CASE_FILE.md").read_text()
    expect(result.stdout.strip() in page, "proto/CASE_FILE.md holds the reference that `strake explain --markdown` prints")


with folder() as place:
    manual_is_found(pathlib.Path(place).resolve())
with folder() as place:
    programs_are_asked_once(pathlib.Path(place).resolve())
with folder() as place:
    place = pathlib.Path(place)
    help_and_version(place)
    check_leaves_nothing(place)
    recorded = run_and_judge(place)
    compare_draws(place, recorded)
    strict_fails(place)
    resume_is_exact(place, recorded)
    resume_loses_nothing(place)
    replay_repeats(place, recorded)
    export_writes_decks(place, recorded)
    full_disk(place)
reference_of_keys()
finish()
