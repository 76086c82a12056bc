"""One version stands in CMake, CITATION.cff, CHANGELOG.md and the programs. Of CHANGELOG.md the newest counts that is no
longer in progress. The programs say it with --version, beside commit and libraries. A new commit compiles one source anew.

    tests/repo/versions.py ROOT BIN      exits 1 where they differ
"""
import pathlib
import re
import subprocess
import sys
import tempfile

root, programs = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
problems = []


def found(file, pattern):
    match = re.search(pattern, (root / file).read_text(encoding="utf-8"), re.M)
    if not match:
        problems.append(f"{file}: no version like {pattern}")
    return match.group(1) if match else None


version = found("CMakeLists.txt", r"^project\(strake VERSION (\S+)")
for file, pattern in (("CITATION.cff", r"^version: (\S+)$"), ("CHANGELOG.md", r"^## (\d+\.\d+\.\d+)$")):
    if (other := found(file, pattern)) != version:
        problems.append(f"{file}: version {other}; CMakeLists.txt has {version}")
headings = re.findall(r"^## (\d+)\.(\d+)\.(\d+)", (root / "CHANGELOG.md").read_text(encoding="utf-8"), re.M)
numbers = [tuple(map(int, heading)) for heading in headings]
if numbers != sorted(numbers, reverse=True):
    problems.append(f"CHANGELOG.md: versions do not fall from top to bottom: {numbers}")

said = 0
for program in sorted(programs.glob("strake*")):
    text = subprocess.run([program, "--version"], capture_output=True, text=True, timeout=60).stdout
    said += 1
    for wanted in (rf"^{program.name} {re.escape(version or '')}\b", r"^commit ([0-9a-f]{12} of \d{4}-\d\d-\d\d|unknown)",
                   r"^built with .*Eigen \d+\.\d+.*HDF5 \d+\.\d+.*ZeroMQ \d+\.\d+.*Protobuf \d+\.\d+"):
        if not re.search(wanted, text, re.M):
            problems.append(f"{program.name} --version: no line {wanted}\n{text}")

users = [path for part in ("proto", "fluid", "structure", "coupler") for path in (root / part).rglob("*.[ch]pp")
         if "commit.hpp\"" in path.read_text(encoding="utf-8")]
if [path.name for path in users] != ["version.cpp"]:
    problems.append(f"sources that a new commit compiles anew: {[str(path) for path in users]}")


def commit_of(source):
    header = source / "commit.hpp"
    subprocess.run(["cmake", f"-DSOURCE={source}", f"-DHEADER={header}", "-P", root / "proto/commit.cmake"], check=True, timeout=60)
    return re.findall(r'"(.*)"', header.read_text())


with tempfile.TemporaryDirectory(prefix="strake-test-") as name:
    place = pathlib.Path(name)
    if (alone := commit_of(place)) != ["unknown", ""]:
        problems.append(f"sources without git: {alone}")
    git = ["git", "-C", place, "-c", "user.name=n", "-c", "user.email=e"]
    subprocess.run([*git, "init", "-q"], check=True)
    subprocess.run([*git, "commit", "-q", "--allow-empty", "-m", "first"], check=True)
    own = commit_of(place)
    if not re.fullmatch(r"[0-9a-f]{12}", own[0]) or not re.fullmatch(r"\d{4}-\d\d-\d\d", own[1]):
        problems.append(f"a checkout: {own}")
    (place / "unpacked").mkdir()
    if (inside := commit_of(place / "unpacked")) != ["unknown", ""]:
        problems.append(f"sources inside another checkout: {inside}")
print("\n".join(problems) or f"version {version} in three files and {said} programs")
sys.exit(bool(problems))
