"""Draws extreme values of every key of the case file at random, and runs `strake check` on each.

`strake check` must answer soon, in little memory, and with an exit code that says what is wrong.

Keys, their kinds and their defaults come from `strake explain --markdown`. A draw changes one key of a case (one in five changes two),
in the file itself or by --set. A finding is a crash, a report of a bug of ours (exit 70), or the loss of an awaited participant (exit
5). So is an answer later than --seconds, or a process with more memory than --memory.

  python3 tests/benchmark/extreme_values.py build/bin --count 200 --seed 1
"""
import argparse
import concurrent.futures
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]
CASES = ["plate_entry", "still_tank", "dam_break", "wedge_entry", "cantilever", "box_entry", "still_tank_3d",
         "sphere_entry_3d", "sloshing", "rolling_tank", "wedge_elastic", "plate_failure"]
PATIENCE = ("coupling.answer_within", "coupling.start_within", "coupling.frozen_after", "coupling.attach_within")
FINE = {0, 2, 3, 4}  # done, or refused with a reason; 4: a solver that cannot set up what is within every range
ADDRESS_SPACE = 8 << 30


def keys_of(strake):
    """Path, kind and default of every key."""
    text = subprocess.run([strake, "explain", "--markdown"], capture_output=True, text=True, check=True).stdout
    table, keys = "", []
    for line in text.splitlines():
        if line.startswith("### "):
            found = re.match(r"### `\[+([^\]]*(?:\[\])?[^\]]*)\]+`", line)
            table = found.group(1) + "." if found else ""
            if found and line.startswith("### `[["):
                table = found.group(1).rstrip("]") + "[]."
        elif line.startswith("| `"):
            cells = [c.strip() for c in re.split(r"(?<!\\)\|", line)[1:-1]]
            keys.append((table + cells[0].strip("`"), cells[1], cells[3].strip("`")))
    return keys


def number(text):
    try:
        return float(text)
    except ValueError:
        return None


def scaled(value, dice):
    """A number times a power of ten, or a list with one of its numbers changed so."""
    factor = dice.choice([1e-6, 1e-3, 1e3, 1e6, -1, 0])
    if isinstance(value, bool) or isinstance(value, str):
        return None
    if isinstance(value, (int, float)):
        return f"{value * factor:g}"
    if isinstance(value, list) and value:
        at = dice.randrange(len(value))
        inner = scaled(value[at], dice)
        return None if inner is None else "[" + ", ".join(inner if i == at else toml(v) for i, v in enumerate(value)) + "]"
    return None


def extreme(kind, present, default, dice):
    """A value as TOML text: half of them what the key expects in kind, the others anything."""
    numbers = ["0", "-1", "1", "1e-300", "-1e-300", "1e300", "-1e300", "inf", "-inf", "nan", "1e-9", "1e9", "1e-5", "1e5",
               "2147483647", "2147483648", "-2147483649", "9223372036854775807", "1000000", "3", "0.5", "1e-6", "1e-4", "1e-3", "0.1", "10", "100", "1e3", "1e4", "1e6", "1e12"]
    base = present if present is not None else number(default)
    texts = ['""', '"' + "a" * 100000 + '"', '"\\u0000\\u0001\\u001b[2J\\n"', '"/dev/zero"', '"/dev/null"', '"/"', '"/tmp"',
             '"%s%n"', '"../../../../etc/passwd"', '"PIPE"', '"x"', '"all"']
    lists = ["[]", "[[]]", "[0, 0]", "[[0, 0], [0, 0]]", "[[0, 0], [1, 0], [1e-12, 1]]", "[1e6, 1e6]",
             "[[-1e6, -1e6, -1e6], [1e6, 1e6, 1e6]]", "[" + "0.1, " * 100000 + "]",
             "[" + ", ".join(f"[{i}, {i % 7}]" for i in range(100000)) + "]", '["' + '", "'.join("ab" * 50000) + '"]',
             "[" * 200 + "]" * 200, "[1e9, 0, 0]", "[1e-9, 0, 0]", "[inf, 0]", "[nan, 0]", "[[0, 0, 0], [1e-9, 1e-9, 1e-9]]"]
    others = ["true", "false", "{}", "{ a = { b = { c = 1 } } }", "1979-05-27T07:32:00Z", "[{}]", "[{}, {}]"]
    changed = scaled(base, dice) if base is not None else None
    if changed and dice.random() < 0.5:
        return changed
    choices = re.split(r"\s*\\\|\s*", kind)
    if len(choices) > 1 and dice.random() < 0.6:
        return '"' + dice.choice(choices) + '"'
    if dice.random() < 0.7:
        if kind.startswith(("number", "integer")):
            return dice.choice(numbers)
        if kind.startswith(("text", "file", "folder", "texts", "scalars")) or len(choices) > 1:
            return dice.choice(texts)
        if kind.startswith(("vector", "box", "points")):
            return dice.choice(lists)
        if kind.startswith("flag"):
            return dice.choice(["true", "false"])
    return dice.choice(numbers + texts + lists + others)


def toml(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, Raw):
        return value.text
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{toml(k)} = {toml(v)}" for k, v in value.items()) + "}"
    return str(value)


class Raw:
    """A value that stands in the file as it is."""
    def __init__(self, text):
        self.text = text


def written(table, path=""):
    """A case as TOML, its tables each under a heading of their own."""
    values = {k: v for k, v in table.items() if not (isinstance(v, dict) or isinstance(v, list) and v and isinstance(v[0], dict))}
    text = "".join(f"{toml(k)} = {toml(v)}\n" for k, v in values.items())
    for key, value in table.items():
        name = path + ("." if path else "") + toml(key)
        if isinstance(value, dict):
            text += f"\n[{name}]\n" + written(value, name)
        elif key not in values:
            text += "".join(f"\n[[{name}]]\n" + written(one, name) for one in value)
    return text


def place(case, path):
    """The table that contains a key, made if it is missing, and the key's last name."""
    steps, table = path.split("."), case
    for step in steps[:-1]:
        if step.endswith("[]"):
            found = table.setdefault(step[:-2], [])
            if not isinstance(found, list) or found and not isinstance(found[0], dict):
                return None, steps[-1]
            if not found:
                found.append({})
            table = found[0]
        else:
            table = table.setdefault(step, {})
            if not isinstance(table, dict):
                return None, steps[-1]
    return table, steps[-1]


class Draw:
    def __init__(self, number, keys, dice, folder):
        self.base = dice.choice(CASES)
        self.file = folder / f"draw_{number}.toml"
        case = tomllib.loads((folder / f"{self.base}.toml").read_text())
        self.changes, self.sets = [], []
        for path, kind, default in dice.sample(keys, 2 if dice.random() < 0.2 else 1):
            table, name = place(case, path)
            if table is None:
                continue
            present = table.get(name)
            value = extreme(kind, None if isinstance(present, dict) else present, default, dice)
            value = value.replace("PIPE", str(folder / "pipe"))
            by_set = len(value) < 1000 and dice.random() < 0.3
            if by_set:
                self.sets += ["--set", path.replace("[]", "[0]") + "=" + value]
            else:
                table[name] = Raw(value)
            self.changes.append(f"{path} = {value if len(value) < 120 else value[:120] + ' ...'}{'  (--set)' if by_set else ''}")
        # Text that TOML itself refuses is refused at once: that is a draw, too.
        self.file.write_text(written(case))


def limits():
    os.setsid()
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def ask(words, cwd, patience):
    """Exit code, seconds, peak memory of the largest process [bytes], what was said."""
    env = dict(os.environ, NO_COLOR="1", OMP_WAIT_POLICY="passive", OPENBLAS_NUM_THREADS="1")
    begin = time.monotonic()
    with tempfile.TemporaryFile("w+", errors="replace") as out:
        process = subprocess.Popen(words, cwd=cwd, env=env, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=out,
                                   preexec_fn=limits)
        late = threading.Timer(patience, lambda: os.killpg(process.pid, signal.SIGKILL))
        late.start()
        _, status, usage = os.wait4(process.pid, 0)
        late.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        said = out.read(4000)
    return process.returncode, time.monotonic() - begin, 1024 * usage.ru_maxrss, said


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin", help="folder of the programs")
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first draw that is asked: to go on with a seed")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=10.0, help="an answer later than this is a finding")
    parser.add_argument("--memory", type=float, default=1e9, help="bytes of one process above which it is a finding")
    parser.add_argument("--only", default="", help="keys that begin so alone")
    options = parser.parse_args()
    strake = str(pathlib.Path(options.bin).resolve() / "strake")
    keys = [key for key in keys_of(strake) if key[0].startswith(options.only)]
    dice = random.Random(options.seed)
    findings, codes, slowest, largest = [], {}, 0.0, 0.0
    with tempfile.TemporaryDirectory(prefix="strake-extreme-") as folder:
        folder = pathlib.Path(folder)
        shutil.copytree(ROOT / "cases", folder, dirs_exist_ok=True, ignore=shutil.ignore_patterns("pictures", "paraview"))
        os.mkfifo(folder / "pipe")

        def one(draw):
            answer = ask([strake, "check", str(draw.file), *draw.sets], folder, 3 * options.seconds)
            draw.file.unlink()
            return draw, answer

        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            draws = (Draw(n, keys, dice, folder) for n in range(options.first + options.count))
            batch = []
            for number, draw in enumerate(draws):
                if number < options.first:
                    draw.file.unlink()
                    continue
                batch.append(pool.submit(one, draw))
                if len(batch) < 4 * options.jobs and draw is not None and len(batch) + 1 <= options.count:
                    continue
                for future in batch[: options.jobs]:
                    report(future.result(), options, findings, codes)
                batch = batch[options.jobs:]
            for future in batch:
                report(future.result(), options, findings, codes)
    print(f"{options.count} draws over {len(keys)} keys, seed {options.seed} from draw {options.first}; exit codes "
          + ", ".join(f"{code}: {n}" for code, n in sorted(codes.items())))
    print(f"slowest {worst['seconds']:.1f} s, largest {worst['memory'] / 1e6:.0f} MB; {len(findings)} findings")
    sys.exit(bool(findings))


worst = {"seconds": 0.0, "memory": 0.0}


def report(result, options, findings, codes):
    draw, (code, seconds, memory, said) = result
    codes[code] = codes.get(code, 0) + 1
    worst["seconds"], worst["memory"] = max(worst["seconds"], seconds), max(worst["memory"], memory)
    why = []
    impatient = code == 5 and any(change.startswith(PATIENCE) for change in draw.changes)
    if code not in FINE and not impatient:  # who waits no time for a participant loses it
        why.append(f"exit {code}")
    if code != 0 and not said.strip():
        why.append("says nothing")
    if seconds > options.seconds:
        why.append(f"{seconds:.1f} s")
    if memory > options.memory:
        why.append(f"{memory / 1e6:.0f} MB")
    if not why:
        return
    findings.append(draw)
    print(f"FINDING {draw.base}: {'; '.join(draw.changes)}\n  {', '.join(why)} (exit {code})\n    "
          + "\n    ".join(said.strip().splitlines()[:6]), flush=True)


if __name__ == "__main__":
    main()
