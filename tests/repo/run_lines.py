"""Every `# run` line of a case file is a command that `strake check` accepts; the README's commands exist. In a study file it is
a command that lists runs, of which `strake check` accepts the last. Of lines of one case that set the same keys one is checked.
A command of strake on any page has options that its --help knows, and those that it needs."""
import concurrent.futures
import functools
import os
import pathlib
import re
import shlex
import subprocess
import sys

root, bin_dir = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
problems, seen = [], set()
checks = []  # of cases, with the line that each is from; all processors share them


def strake(*words):
    return subprocess.run([str(bin_dir / "strake"), *words], cwd=root, capture_output=True, text=True, timeout=120)


def check(case, line, words):
    for option in ("--tag", "--runs"):
        while option in words:
            at = words.index(option)
            del words[at:at + 2]
    alike = (words[0], *sorted(word.split("=")[0] for word in words[1:]))
    if alike in seen:
        return
    seen.add(alike)
    checks.append((case, line, words))


def problem_of(one):
    case, line, words = one
    result = strake("check", *words)
    return f"{case.name}: `{line}` exits {result.returncode}:\n{result.stderr}" if result.returncode != 0 else ""


def check_study(case, line):
    result = strake(*shlex.split(line)[1:], "--list")
    runs = [l.strip() for l in result.stdout.splitlines() if l.strip().startswith("strake run ")]
    if result.returncode != 0 or not runs:
        problems.append(f"{case.name}: `{line}` exits {result.returncode}:\n{result.stderr}")
        return
    check(case, runs[-1], shlex.split(runs[-1])[2:])


@functools.lru_cache(None)
def options(*command):
    """Options that a command knows, and those without which it refuses."""
    said = strake(*command, "--help").stdout
    needed = set(re.findall(r"^ +(--[\w-]+).*REQUIRED", said, re.M))
    operands = {"--" + name.lower() for name in re.findall(r"^ +([A-Z]+) .*REQUIRED", said, re.M)}  # with or without "--"
    return set(re.findall(r"--[a-z][\w-]*", said)), needed - operands


def check_page(page):
    text = page.read_text(encoding="utf-8")
    for line in re.findall(r"`(strake [^`\n]+)`", text) + re.findall(r"^(strake [^\n#|;]+)", text, re.M):
        words = line.replace("…", "").split()
        command = words[1:3] if words[1] == "new" and len(words) > 2 and words[2].isalpha() and words[2].islower() else words[1:2]
        known, needed = options(*command)
        given = {word.split("=")[0] for word in words[2:] if re.match(r"--[a-z]", word)}
        operands = [word for word in words[1 + len(command):] if not word.startswith("-")]
        for option in sorted(given - known):
            problems.append(f"{page.relative_to(root)}: `{line}`: no option {option}")
        for option in sorted(needed - given if operands else ()):
            problems.append(f"{page.relative_to(root)}: `{line}` lacks {option}")


for page in sorted(root.rglob("*.md")):
    if not page.relative_to(root).parts[0].startswith(("build", "runs", ".")):
        check_page(page)
for case in sorted((root / "cases").rglob("*.toml")):
    lines = [l[len("# run"):].strip() for l in case.read_text(encoding="utf-8").splitlines() if l.startswith("# run ")]
    if not lines:
        problems.append(f"{case.name}: no `# run` line")
    for line in lines:
        words = shlex.split(line)
        if words[:2] == ["strake", "run"]:
            check(case, line, words[2:])
        elif words[:2] == ["strake", "study"]:
            check_study(case, line)
        elif words[:2] != ["strake", "report"]:
            problems.append(f"{case.name}: `{line}` is not a strake run, study or report command")
with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
    problems += filter(None, pool.map(problem_of, checks))
readme = (root / "README.md").read_text(encoding="utf-8")
for script in re.findall(r"^\s*((?:cases|tests)/\w+\.sh)", readme, re.M):
    if not (root / script).exists():
        problems.append(f"README.md names {script}, which does not exist")
for name in re.findall(r"cases/run\.sh (\w+)", readme):
    if not any((root / "cases" / where).exists() for where in (f"{name}.toml", f"{name}/{name}.toml")):
        problems.append(f"README.md runs the case {name}, which does not exist")
print("\n".join(problems) or f"{len(checks)} run lines accepted by strake check")
sys.exit(bool(problems))
