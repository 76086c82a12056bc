"""The Debian packages, as a user has them: checked by lintian, installed in a bare Debian, used, removed.

    tests/packages/install.py ROOT FOLDER [--keep]     FOLDER: where coupler/package/build.sh left them; needs root

Each step prints how long it took. The time from `apt install` to the first verdict of plate_entry is at most two minutes.
"""
import json
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

from chroot import Chroot

ROOT, FOLDER = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
NAMES = ("strake", "libstrake-dev", "python3-strake", "strake-doc")
FIRST_VERDICT = 120  # [s] from `apt install` on
failures = []
began = time.monotonic()


def expect(condition, what):
    print(("  ok    " if condition else "  FAIL  ") + what, flush=True)
    if not condition:
        failures.append(what)


class Step:
    """A part of the test, with its time."""

    def __init__(self, what):
        self.what = what

    def __enter__(self):
        print(f"{time.monotonic() - began:7.1f} s  {self.what}", flush=True)
        self.start = time.monotonic()

    def __exit__(self, *_):
        print(f"           took {time.monotonic() - self.start:.1f} s", flush=True)


def package(name):
    found = list(FOLDER.glob(f"{name}_*.deb"))
    if len(found) != 1:
        raise SystemExit(f"{FOLDER} holds {len(found)} packages {name}; coupler/package/build.sh makes one")
    return found[0]


def field(deb, name):
    return subprocess.run(["dpkg-deb", "-f", deb, name], capture_output=True, text=True, check=True).stdout.strip()


def contents_are_right():
    """What the control files say, and what must not be in them."""
    versions = {field(package(name), "Version") for name in NAMES}
    expect(len(versions) == 1 and re.fullmatch(r"\d+\.\d+\.\d+(\+git\d{8}\.[0-9a-f]{12})?(\+changed)?-1", min(versions)), f"one version: {versions}")
    depends = field(package("strake"), "Depends")
    expect(re.search(r"libdeal\.ii-\d", depends) and all("(" in one for one in depends.split(", ") if one.startswith(("libc6", "libstdc"))),
           f"strake depends on {depends}")
    for name in NAMES:
        listed = subprocess.run(["dpkg-deb", "--ctrl-tarfile", package(name)], capture_output=True, check=True).stdout
        control = subprocess.run(["tar", "-t"], input=listed, capture_output=True, check=True).stdout.decode().split()
        expect("./md5sums" in control and not {"./shlibs", "./triggers", "./symbols"} & set(control), f"{name}: no library for others {control}")
        expect(not field(package(name), "Provides"), f"{name}: provides nothing but itself")


def lintian():
    said = subprocess.run(["lintian", "--allow-root", "--tag-display-limit", "0", *[package(name) for name in NAMES]],
                          capture_output=True, text=True).stdout
    tags = [line for line in said.splitlines() if re.match(r"[EWIXO]: ", line)]
    for line in tags:
        print(f"        {line}")
    count = {letter: sum(line.startswith(letter) for line in tags) for letter in "EW"}
    expect(count["E"] == 0, f"lintian: {count['E']} errors, {count['W']} warnings")


def first_five_minutes(debian):
    """From `apt install` to the first verdict, as a newcomer would."""
    start = time.monotonic()
    debian.run(f"apt-get install -y /packages/{package('strake').name}", user=False)
    installed = time.monotonic() - start
    process, lines = debian.lines("mkdir first && cd first && exec strake run plate_entry")
    verdict = None
    for came, line in lines:
        if not verdict and re.match(r"\s*(pass|fail)\b", line):
            verdict = came - start
            print(f"        {line.strip()}")
            process.send_signal(signal.SIGINT)  # the case goes on for another minute and a half
    code = process.wait()
    expect(verdict and verdict <= FIRST_VERDICT, f"apt install {installed:.1f} s, to the first verdict {verdict and round(verdict, 1)} s (at most {FIRST_VERDICT} s)")
    expect(code == 130, f"Ctrl-C ends it in order: exit {code}")
    added = debian.run("dpkg-query -W -f '${Installed-Size}\\n' | awk '{n++; kb += $1} END {print n \" packages, \" int(kb/1024) \" MB\"}'").strip()
    print(f"        then installed: {added}")


def a_case(debian):
    told = debian.run("strake run still_tank --strict")
    expect("pass" in told and "fail" not in told, "strake run still_tank: met")
    listed = debian.run("ls -A")
    expect(listed.split() == ["first", "runs"], f"its run lies in the working folder: {listed.split()}")
    debian.run("STRAKE_VECTORS=narrow strake run still_tank --strict --tag narrow")
    programs = [json.loads((debian.root / "home/user/runs" / run / "run.json").read_text())["participants"]["fluid"]["program"]
                for run in ("still_tank", "still_tank-narrow")]
    wide = "/usr/lib/strake/x86-64-v3/strake-fluid" if {"avx2", "fma", "bmi2"} <= set(pathlib.Path("/proc/cpuinfo").read_text().split()) else "/usr/bin/strake-fluid"
    expect(programs == [wide, "/usr/bin/strake-fluid"], f"the fluid for this processor, and the narrow one where it is asked for: {programs}")
    expect("did you mean still_tank?" in debian.run("strake run still_tan", code=3), "a mistyped name is told")
    told = debian.run("strake run plate_entry --set structure.solver=particle --set end_time=2e-5 --tag particle")
    expect("done  2 windows" in told, "another structure runs")
    expect("strake " + field(package("strake"), "Version").partition("+")[0].partition("-")[0] in debian.run("strake --version"), "the version is the package's")
    commit = field(package("strake"), "Version").rpartition(".")[2].partition("-")[0].removesuffix("+changed")
    expect(f"commit {commit}" in debian.run("strake --version") or "+git" not in field(package("strake"), "Version"), f"and so is the commit {commit}")
    expect("no manual" in debian.run("strake manual", code=2), "no manual without strake-doc")


def find_package(debian):
    """A solver in C++ by find_package(strake), in the place of the one in Python."""
    debian.give(ROOT / "tests/system/foreign", "solver")
    debian.run("cmake -S solver -B made -DCMAKE_BUILD_TYPE=Release && cmake --build made")
    told = debian.run('strake run python_spring --set "structure.solver=$PWD/made/spring" --strict --tag cpp')
    expect("pass" in told, "find_package(strake): the floor on a spring in C++ is met")


def python(debian):
    said = debian.run("cd / && python3 -c 'import strake; print(strake.__file__, strake.__version__)'")
    expect(said.startswith("/usr/lib/python3/dist-packages/strake/"), f"import strake: {said.strip()}")
    expect("No module named" in debian.run("cd / && python3 -c 'import precice'", code=1), "import precice finds nothing outside of runs")
    expect("No module named" in debian.run("cd / && python3 -c 'import coupling_pb2'", code=1), "nor import coupling_pb2")
    told = debian.run("strake run python_spring --strict")
    expect("pass" in told, "python_spring: a solver in Python is met")
    said = debian.run("python3 -c 'import strake; r = strake.open(\"runs/python_spring\"); print(len(r.column(\"iterations\")))'")
    expect(said.strip() == "175", f"strake.open: {said.strip()} windows")
    said = debian.run("python3 -c 'import strake; print(strake.run(\"cantilever\").folder)'")
    expect("cantilever" in said, f"strake.run by name: {said.strip()}")
    floor = debian.give(ROOT / "tests/system/python/floor", "floor")
    text = (ROOT / "cases/python_spring/python_spring.toml").read_text().partition("[[output.probe]]")[0]
    (floor / "floor.toml").write_text(text.replace('"./spring.py"', '"./floor.py"'))
    expect("done  175 windows" in debian.run("strake run floor/floor.toml"), "a solver for preCICE's Python bindings runs")


def precice(debian):
    """The private prefix: found where somebody asks for it, and nowhere else."""
    prefix = "/usr/lib/strake/precice"
    expect("precice" not in debian.run("ldconfig -p", user=False), "the loader does not know libprecice")
    debian.run("pkg-config --exists libprecice", code=1)
    debian.give(ROOT / "tests/precice/solvers", "precice")
    said = debian.run("cd precice && cmake -S . -B made 2>&1", code=1)
    expect("precice" in said and "CMAKE_PREFIX_PATH" in said, "find_package(precice) without its folder finds nothing")
    debian.run(f"cd precice && rm -rf made && cmake -S . -B made -Dprecice_DIR={prefix} -DCMAKE_BUILD_TYPE=Release && cmake --build made --target spring dummy_c")
    told = debian.run("cd precice && strake run spring.toml --strict")
    expect("done  175 windows" in told, "find_package(precice 3): the floor on a spring by libprecice runs")
    debian.run(f"cd precice && g++ -std=c++11 dummy.cpp -o dummy_11 $(PKG_CONFIG_PATH={prefix} pkg-config --cflags --libs libprecice)")
    said = debian.run(f"cd precice && ldd dummy_11; LD_LIBRARY_PATH={prefix} ldd dummy_11")
    expect("libprecice.so.3 => not found" in said and f"libprecice.so.3 => {prefix}/libprecice.so.3" in said, "pkg-config: links with it, loads it where asked")


def pages(debian):
    where = debian.run("strake manual").strip()
    expect(where == "/usr/share/doc/strake/html/index.html" and (debian.root / where[1:]).exists(), f"strake manual: {where}")
    debian.run("apt-get install -y --no-install-recommends man-db bash-completion", user=False)
    for program in sorted(path.name for path in (debian.root / "usr/bin").glob("strake*")):
        expect("SYNOPSIS" in debian.run(f"man {program}"), f"man {program}")
    expect("--resume" in debian.run("man strake-run"), "man strake-run")
    shell = """bash -c '. /usr/share/bash-completion/bash_completion; _completion_loader strake
      COMP_WORDS=(strake run plate_en); COMP_CWORD=2; _strake; echo "${COMPREPLY[@]}"'"""
    expect("plate_entry" in debian.run(shell).split(), "TAB completes the name of a case")


def removed(debian, before):
    debian.run(f"apt-get purge -y {' '.join(NAMES)}", user=False)
    mine = sorted(name for name in debian.files() - before if re.search("strake|precice|coupling_pb2", name))
    expect(not mine, f"nothing of Strake is left {mine}")
    expect("strake" not in debian.run("dpkg -l"), "dpkg knows it no more")
    debian.run("apt-get purge -y cmake g++ man-db bash-completion && apt-get autoremove --purge -y", user=False)
    others = sorted(debian.files() - before)
    print(f"        {len(others)} files of other packages are left" + (": " + " ".join(others[:12]) if others else ""))


def use(debian):
    for name in NAMES:
        shutil.copy(package(name), debian.root / "packages")
    debian.run("apt-get update", user=False)
    before = debian.files()
    with Step("strake alone, to the first verdict of plate_entry"):
        first_five_minutes(debian)
    with Step("cases by name"):
        a_case(debian)
    with Step("the other three packages"):
        debian.run("apt-get install -y " + " ".join(f"/packages/{package(name).name}" for name in NAMES[1:]), user=False)
    for part in (python, find_package, precice, pages):
        with Step(part.__name__):
            part(debian)
    with Step("removed"):
        removed(debian, before)


def main():
    with Step("control files"):
        contents_are_right()
    with Step("lintian"):
        lintian()
    print(f"{time.monotonic() - began:7.1f} s  a bare Debian", flush=True)
    with Chroot(keep="--keep" in sys.argv) as debian:
        use(debian)
    print(f"{time.monotonic() - began:7.1f} s  {len(failures)} failed")
    sys.exit(bool(failures))


if __name__ == "__main__":
    main()
