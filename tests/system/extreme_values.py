"""Values far beyond any case are refused by their key, soon and in little memory. A path that is no file is not read.
The long version draws values at random: tests/benchmark/extreme_values.py."""
import os
import resource
import shutil
import subprocess

from processes import *  # noqa: F403: the test's own vocabulary

BIN = BIN.resolve()
LIMIT = 1 << 30  # bytes that one program may take before it refuses
PATIENCE = 10  # seconds

# (case, what is set, words that the message must contain)
SIZES = [
    ("plate_entry", ["structure.plate.length=400000"], ["structure.plate", "a body inside the tank", "fix: move or shorten the body"]),
    ("plate_entry", ["structure.plate.thickness=2e-9"], ["structure.plate.thickness", "at most", "or more"]),
    ("plate_entry", ["structure.plate.length=1e9"], ["structure.plate.length", "1e-9 to 1e6"]),
    ("plate_entry", ["fluid.spacing=1e-9"], ["fluid.spacing", "water particles", "or more"]),
    ("plate_entry", ["fluid.spacing=1e-5"], ["fluid.spacing", "water particles", "or more"]),
    ("plate_entry", ["structure.surface_spacing=1e-9"], ["structure.surface_spacing", "points of the surface", "or more"]),
    ("plate_entry", ["structure.solver=particle", "structure.particle.spacing=1e-7"],
     ["structure.particle.spacing", "particles of the structure", "or more"]),
    ("plate_entry", ["structure.material.young=1e300"], ["structure.material.young", "0.001 to 1e15"]),
    ("plate_entry", ["structure.material.density=1e300"], ["structure.material.density", "1e-6 to 1e6"]),
    ("plate_entry", ["fluid.scheme.time_step=1e-300"], ["fluid.scheme.time_step"]),
    ("plate_entry", ["end_time=1e9"], ["end_time", "windows"]),
    ("plate_entry", ["run.threads=100000"], ["run.threads", "1024"]),
    ("sphere_entry_3d", ["structure.surface_spacing=1e-6"], ["structure.surface_spacing", "or more"]),
    ("dam_break_3d", ["fluid.spacing=1e-5"], ["fluid.spacing", "or more"]),
]
# Keys that name a file, each with what is no file.
FILES = [
    ("rolling_tank", ["fluid.motion.file=PATH"], "fluid.motion.file"),
    ("wedge_elastic", ["structure.mesh=PATH"], "structure.mesh"),
    ("dam_break", ["compare[0].file=PATH"], "file"),
]


def guarded():
    resource.setrlimit(resource.RLIMIT_AS, (6 << 30, 6 << 30))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def answer(words, cwd):
    """Exit code, what was said, seconds, bytes of the largest process."""
    begin = time.monotonic()
    with tempfile.TemporaryFile("w+") as said:
        process = subprocess.Popen([str(BIN / "strake"), *map(str, words)], cwd=cwd, env=ENV, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=said, preexec_fn=guarded)
        while time.monotonic() - begin < 2 * PATIENCE:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            time.sleep(0.005)
        else:
            end(process)
            return None, "", time.monotonic() - begin, 0
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        return process.returncode, said.read(), time.monotonic() - begin, 1024 * usage.ru_maxrss


def expect_refused(what, words, cwd, told):
    code, said, seconds, memory = answer(words, cwd)
    expect(code == 3 and all(word in said for word in told) and "fix:" in said and seconds < PATIENCE and memory < LIMIT,
           f"{what}: exit {code} after {seconds:.1f} s and {memory / 1e6:.0f} MB, the message holds {told}\n{said.rstrip()}")


with folder() as place:
    place = pathlib.Path(place)
    shutil.copytree(ROOT / "cases", place / "cases", ignore=shutil.ignore_patterns("pictures", "paraview"))
    for number, (case, sets, told) in enumerate(SIZES):
        for command in ("check", "run") if number < 4 else ("check",):
            words = [command, place / "cases" / f"{case}.toml"] + [w for s in sets for w in ("--set", s)]
            expect_refused(f"{command} {case} {' '.join(sets)}", words, place, told)
    expect(not (place / "runs").exists(), "no run folder is left")

    os.mkfifo(place / "pipe")
    for path in ("/dev/zero", place / "pipe"):
        for command in ("check", "run", "study"):
            expect_refused(f"{command} {path}", [command, path], place, ["is a pipe, a device or a socket"])
        for case, sets, key in FILES:
            words = ["check", place / "cases" / f"{case}.toml"]
            words += [w for s in sets for w in ("--set", s.replace("PATH", str(path)))]
            expect_refused(f"{' '.join(sets)} with {path}", words, place, [key, "is a pipe, a device or a socket"])

    # A case that is large and legal is answered by its size.
    code, said, seconds, memory = answer(["check", place / "cases" / "plate_entry.toml", "--set", "fluid.spacing=4e-4",
                                          "--set", "structure.solver=rigid", "--set", "structure.plate.bottom=[0, 0.012, 0]"], place)
    expect(code == 0 and seconds < PATIENCE and memory < LIMIT,
           f"a large case is not built by a check: exit {code}, {seconds:.1f} s, {memory / 1e6:.0f} MB\n{said}")
    result = strake("check", ROOT / "cases" / "plate_entry.toml", cwd=place)
    expect("size       fluid: about 10 000 water particles" in result.stdout, "a check tells the size of each side")
finish()
