"""The sources of tests/benchmark compile, though a build does not make them. Each is read with the command that would compile it, up to
what the compiler says of it: no code is made. The benchmarks in Python are read as well.

    tests/repo/benchmarks.py ROOT BIN      exits 1 where one does not compile, 77 where Google's benchmark library is missing
"""
import concurrent.futures
import json
import os
import pathlib
import shlex
import subprocess
import sys

root, build = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve().parent
folder = root / "tests" / "benchmark"


def reading(entry):
    """The command of a source, without the compiler's cache before it and the object file."""
    words = shlex.split(entry["command"])
    compiler = next(k for k, word in enumerate(words) if pathlib.Path(word).name.split("-")[0] in ("c++", "g++", "clang++"))
    words = words[compiler:]
    at = words.index("-o")
    del words[at:at + 2]
    return ["-fsyntax-only" if word == "-c" else word for word in words]


def problem_of(entry):
    done = subprocess.run(reading(entry), cwd=entry["directory"], capture_output=True, text=True)
    return done.stderr if done.returncode else ""


commands = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
sources = {pathlib.Path(entry["file"]): entry for entry in commands if folder in pathlib.Path(entry["file"]).parents}
if not sources:
    print("Google's benchmark library is missing: no benchmark is known to this build")
    sys.exit(77)
with_elements = (build / "bin" / "strake-structure-fem").exists()
problems = [f"{source.relative_to(root)}: no target compiles it" for source in sorted(folder.rglob("*.cpp"))
            if with_elements and source not in sources]
with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
    problems += [problem for problem in pool.map(problem_of, sources.values()) if problem]
scripts = sorted(folder.rglob("*.py"))
for script in scripts:
    try:
        compile(script.read_text(encoding="utf-8"), str(script), "exec")
    except SyntaxError as error:
        problems.append(f"{script.relative_to(root)}:{error.lineno}: {error.msg}")
print("\n".join(problems) or f"{len(sources)} sources and {len(scripts)} scripts of benchmarks compile")
sys.exit(bool(problems))
