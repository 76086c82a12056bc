"""CalculiX as the structure of a run. It agrees with the finite elements, window by window and once for a recorded load,
and resumes bit-equal. Messages are checked if it is missing, fails, is slow or finds the disk full."""
import shutil

from processes import *  # noqa: F403: the test's own vocabulary

CASE = ROOT / "cases" / "plate_entry.toml"
# A coarse plate that meets coarse water in its tenth window.
SETS = [word for key in (
    "fluid.spacing=0.02", "structure.plate.bottom=[0,0.024,0]", "structure.velocity=[0,-24,0]",
    "structure.fem.refinement=0", "coupling.surface.window=1e-4", "end_time=1.6e-3", "output.every=4e-4",
    "run.threads=1") for word in ("--set", key)]
CCX = ["--set", "structure.solver=ccx"]


def quick_case(place):
    """plate_entry, coarse, with one probe and no comparison."""
    text = CASE.read_text()
    text = text[:text.index("[[output.probe]]")] + """
[[output.probe]]
name = "mid"
of = "structure"
at = [0.0, 0.024, 0.0]
quantity = "deflection"
"""
    case = place / "plate.toml"
    case.write_text(text)
    return case


def column(run, name):
    lines = (run / "history.csv").read_text().splitlines()
    at = lines[0].split(",").index(name)
    return [float(line.split(",")[at]) for line in lines[1:]]


def gap(one, other):
    return (sum((a - b) ** 2 for a, b in zip(one, other)) / sum(b * b for b in other)) ** 0.5


def coupled(place, case):
    fem = strake("run", case, *SETS, "--tag", "fem", cwd=place)
    expect(fem.returncode == 0, f"run with fem: exit {fem.returncode}\n{fem.stderr}")
    ccx = strake("run", case, *SETS, *CCX, "--tag", "ccx", cwd=place, timeout=300)
    expect(ccx.returncode == 0, f"run with ccx: exit {ccx.returncode}\n{ccx.stderr}")
    runs = [place / "runs" / f"plate-{tag}" for tag in ("fem", "ccx")]
    deflection = [column(run, "mid.y [m]") for run in runs]
    distance = gap(deflection[1], deflection[0])
    expect(max(map(abs, deflection[0])) > 1e-4, f"the plate bends, by {max(map(abs, deflection[0])):.2e} m")
    expect(distance < 0.01, f"coupled with the water, ccx moves as fem does: {100 * distance:.2f} % in L2")
    expect(len(list((runs[1] / "frames").glob("structure-*.h5"))) == len(list((runs[0] / "frames").glob("structure-*.h5"))),
           "as many frames")
    expect(not (runs[1] / "ccx").exists(), "CalculiX's files are gone")
    return runs[0], runs[1]


def resumed(place, case, whole):
    words = ["run", case, *SETS, *CCX, "--tag", "cut"]
    cut = place / "runs" / "plate-cut"
    process = start(*words, cwd=place)
    expect(wait_until(lambda: rows(cut) >= 6, 120), "resume: the run is under way")
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    again = strake(*words, "--resume", cwd=place, timeout=300)
    expect(again.returncode == 0, f"resume: exit {again.returncode}\n{again.stderr}")
    expect((cut / "history.csv").read_bytes() == (whole / "history.csv").read_bytes(), "resume: the same to the byte")


def replayed(place, case, recorded):
    result = strake("replay", recorded, "--onto", case, *SETS, *CCX, cwd=place)
    expect(result.returncode == 0, f"replay: exit {result.returncode}\n{result.stderr}")
    expect("one call before the first window" in result.stdout, "replay says how CalculiX is called")
    run = place / "runs" / "plate-replay"
    distance = gap(column(run, "mid.y [m]"), column(recorded, "mid.y [m]"))
    expect(distance < 0.01, f"under the recorded load ccx moves as fem did: {100 * distance:.2f} % in L2")
    frames = sorted((run / "frames").glob("structure-*.h5"))
    expect(len(frames) > 2, f"{len(frames)} frames")


def program(folder, text):
    folder.mkdir(exist_ok=True)
    (folder / "ccx").write_text("#!/bin/sh\n" + text)
    (folder / "ccx").chmod(0o755)


def refused(place, case, recorded, what, words, code, *sets):
    result = strake("replay", recorded, "--onto", case, *SETS, *CCX, *sets, "--force", cwd=place)
    expect(result.returncode == code, f"{what}: exit {result.returncode}, expected {code}")
    expect(all(w in result.stderr for w in words), f"{what}: the message holds {words}\n{result.stderr.rstrip()}")
    expect("fix:" in result.stderr, f"{what}: the message says how to fix it")


def failures_are_told(place, case, recorded):
    path = ENV["PATH"]
    try:
        ENV["PATH"] = str(place / "nothing")
        result = strake("check", case, *SETS, *CCX, cwd=place)
        expect(result.returncode == 3 and "apt install calculix-ccx" in result.stderr,
               f"not installed: exit {result.returncode}\n{result.stderr.rstrip()}")
        fake = place / "fake"
        ENV["PATH"] = f"{fake}:{path}"
        version = 'if [ "$1" = -v ]; then echo "This is Version 2.20"; exit 0; fi\n'
        program(fake, version + "echo ' *ERROR in the test: nothing works'; exit 201\n")
        refused(place, case, recorded, "a program that fails", ["*ERROR in the test", "201", "kept in"], 4)
        kept = place / "runs" / "plate-replay" / "ccx" / "deck.inp"
        expect(kept.exists(), "its deck is kept")
        program(fake, version + "exit 0\n")
        refused(place, case, recorded, "a program that computes nothing", ["ended well and printed 0"], 4)
        program(fake, version + "exec sleep 60\n")
        refused(place, case, recorded, "a program that hangs", ["within 1 s", "answer_within"], 4,
                "--set", "structure.ccx.answer_within=1")
    finally:
        ENV["PATH"] = path


if not (BIN / "strake-structure-ccx").exists():
    print("skip  there is no strake-structure-ccx: it is built with deal.II")
elif shutil.which("ccx") is None:
    print("skip  ccx is not installed (Debian: apt install calculix-ccx)")
else:
    with folder() as place:
        place = pathlib.Path(place)
        case = quick_case(place)
        by_fem, by_ccx = coupled(place, case)
        resumed(place, case, by_ccx)
        replayed(place, case, by_fem)
        failures_are_told(place, case, by_fem)
finish()
