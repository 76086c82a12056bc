"""Processes and files that are not ours stay as they are, with every command. These are jobs that the shell had before it
became `strake`, and files in the current folder, beside the case and under runs/."""
import hashlib
import shutil

from processes import *  # noqa: F403: the test's own vocabulary

CASE = "case/cantilever.toml"
TINY = "--set end_time=2e-4"
COMMANDS = [  # of the README, in an order in which each finds what it needs
    f"run {CASE} {TINY}", f"run {CASE} {TINY} --force", f"run {CASE} --set structure.material.young=-1 --tag refused",
    "run case/python_spring/python_spring.toml --set end_time=1e-3", f"check {CASE}", "explain fluid", "compare runs/cantilever",
    "report runs/cantilever", "watch runs/cantilever", "picture runs/cantilever -o x.png",
    "check case/python_spring/python_spring.toml", "export runs/cantilever --to ccx", "keys keys",
    "replay runs/python_spring --onto case/python_spring/python_spring.toml --set end_time=5e-4 --tag again",
    "study case/study.toml",
]
STUDY = """title = "two lengths"
case = "cantilever.toml"
[[axis]]
name = "end"
value = [{ label = "short", set = ["end_time=1e-4"] }, { label = "long", set = ["end_time=2e-4"] }]
"""


def sums(place):
    return {path.relative_to(place): hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(place.rglob("*")) if path.is_file() and not path.is_symlink()}


with folder() as place:
    place = pathlib.Path(place)
    shutil.copytree(ROOT / "cases", place / "case", ignore=shutil.ignore_patterns("pictures", "__pycache__"))
    (place / "case" / "study.toml").write_text(STUDY)
    for other in ("notes.txt", "runs/notes.txt", "runs/other/case.toml", "case/notes.part", "runs/other/000001.h5.part"):
        (place / other).parent.mkdir(parents=True, exist_ok=True)
        (place / other).write_text("mine\n")
    before = sums(place)
    for words in COMMANDS:
        # The shell's two jobs are children of the process that becomes strake. One of them is in a session of its own.
        script = f"sleep 333 & echo $!; setsid sleep 334 & echo $!; exec {BIN / 'strake'} {words} >log.txt 2>&1"
        shell = subprocess.Popen(["bash", "-c", script], cwd=place, env=ENV, stdout=subprocess.PIPE, text=True)
        jobs = [int(shell.stdout.readline()) for _ in range(2)]
        try:
            code = shell.wait(timeout=120)
            wanted = 3 if "refused" in words else 0
            expect(code == wanted, f"{words}: exit {code}" + ("" if code == wanted else "\n" + (place / "log.txt").read_text()))
            expect(all(alive(job) for job in jobs), f"{words}: the shell's jobs live")
        finally:
            for job in jobs:
                os.kill(job, signal.SIGKILL)
    (place / "log.txt").unlink()
    after = sums(place)
    changed = [str(path) for path, digest in before.items() if after.get(path) != digest]
    expect(not changed, f"no file that was there has changed: {changed}")
    new = {path.parts[0] for path in after if path not in before and path.parts[0] != "runs"}
    expect(new == {"x.png", "keys"}, f"outside runs/ there is only what was asked for: {sorted(new)}")
finish()
