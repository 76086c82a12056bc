"""Runs and studies started from Python: the program `strake` does them, and its words are the errors."""
import json
import math
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile

from .errors import Error

TO_END = 20  # [s] for a run to save its state: more than its own patience with a solver


def find_program(name="strake"):
    """Finds a program: in STRAKE_BIN, beside this package, or on PATH. The Error says where it was looked for."""
    package = pathlib.Path(__file__).resolve().parent
    given = os.environ.get("STRAKE_BIN", "")
    beside = [package.parent.parent / "bin", package.parent.parent.parent.parent / "bin"]  # a build, an installation
    for folder in ([pathlib.Path(given)] if given else beside):
        program = folder if given and folder.is_file() else folder / name
        if program.is_file() and os.access(program, os.X_OK):
            return program
    found = None if given else shutil.which(name)
    if found:
        return pathlib.Path(found)
    looked = f"{given} (STRAKE_BIN)" if given else f"{beside[0]}, {beside[1]} or on PATH"
    raise Error(f"no program {name} in {looked}", "set STRAKE_BIN to the folder that holds it, such as build/bin", exit_code=2)


def run(case, set=None, folder="runs", tag=None, force=False, resume=False, strict=False, follow=None):  # noqa: A002
    """Runs a case to its end and returns the run, opened.

    case     the case file
    set      keys to change: {"fluid.spacing": 0.01}
    folder   where run folders are made; the run is folder/<case>, or folder/<case>-<tag>
    force    an earlier run of that name is replaced; resume: it goes on from its last checkpoint
    strict   a reference outside its tolerance, or an alarm, is an error with exit code 1
    follow   a function that is called with each line of the JSON console as a dict (proto/RESULTS.md)
    Error with the program's words and exit code where the run does not end with 0.
    """
    from .run_folder import Run
    words = ["run", str(case), "--json", "--runs", str(folder), *settings(set)]
    words += ["--tag", str(tag)] if tag else []
    words += [option for option, wanted in (("--force", force), ("--resume", resume), ("--strict", strict)) if wanted]
    written = []

    def hear(line):
        try:
            said = json.loads(line)
        except ValueError:
            return
        if said.get("kind") in ("start", "end"):
            written.append(said["folder"])
        if follow:
            follow(said)

    code, errors = call(words, hear)
    if code != 0:
        error = Error(errors or f"strake run {case} ended with exit code {code}", exit_code=code)
        error.run = Run(written[0]) if written else None
        raise error
    return Run(written[-1])


def study(file, folder="runs", jobs=None, again=False, strict=False, follow=None):
    """Runs a study to its end and returns it, opened. Runs that are done already are not done again, unless `again`.

    folder   the study is folder/<study>; jobs: runs at once, not given: one for each core
    strict   a check that fails is an error with exit code 1
    follow   a function that is called with each line of the console
    Error with the program's words and exit code where the study does not end with 0.
    """
    from .study_folder import Study
    words = ["study", str(file), "--runs", str(folder)]
    words += ["--jobs", str(jobs)] if jobs else []
    words += [option for option, wanted in (("--again", again), ("--strict", strict)) if wanted]
    said = []

    def hear(line):
        said.append(line)
        if follow:
            follow(line)

    code, errors = call(words, hear)
    if code != 0:
        raise Error(errors or "\n".join(said[-20:]) or f"strake study {file} ended with exit code {code}", exit_code=code)
    return Study(pathlib.Path(folder) / pathlib.Path(file).stem)


def call(words, hear):
    """Starts `strake`; `hear` gets each line of its output. Returns the exit code and what it printed as errors.

    Ctrl-C ends the program in order, with its state saved, and is then raised here.
    """
    with tempfile.TemporaryFile("w+", errors="replace") as errors:
        # A group of its own: Ctrl-C reaches this process alone, which sends one signal. A second would end the run unsaved.
        process = subprocess.Popen([str(find_program()), *words], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=errors,
                                   env=dict(os.environ, NO_COLOR="1"), text=True, errors="replace", process_group=0)
        try:
            with process.stdout:
                for line in process.stdout:
                    hear(line.rstrip("\n"))
            code = process.wait()
        except BaseException:
            end(process)
            raise
        errors.seek(0)
        return code if code >= 0 else 128 - code, errors.read().strip()


def end(process):
    """Ends the program in order, and by force where it has not ended after TO_END."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
        process.send_signal(number)
        try:
            process.wait(TO_END)
            return
        except subprocess.TimeoutExpired:
            continue


def settings(keys):
    """--set options of a dict of keys, or of a list of texts KEY=VALUE."""
    if keys is None:
        return []
    if not isinstance(keys, dict):
        texts = [keys] if isinstance(keys, str) else list(keys)
    else:
        texts = [f"{key}={toml(value, key)}" for key, value in keys.items()]
    return [word for text in texts for word in ("--set", text)]


def toml(value, key):
    """A value as TOML; Error where TOML has nothing of that type."""
    value = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return "nan" if math.isnan(value) else repr(value) if math.isfinite(value) else ("inf" if value > 0 else "-inf")
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(json.dumps(v, ensure_ascii=False) if isinstance(v, str) else toml(v, key) for v in value) + "]"
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    raise Error(f"{key} = {value!r} is a {type(value).__name__}, expected a number, a text, true, false or a list", exit_code=2)
