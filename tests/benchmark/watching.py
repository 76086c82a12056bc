"""Measures what watching costs a run. The same run goes alone, beside `strake watch` on a terminal, and beside a page, in
turn. The page requests news, lines and the newest frames as a browser does. By hand: watching.py BIN [pairs] [case and
options] Processor seconds are those of the run's own processes; those of the watcher are printed beside them."""
import json
import os
import pathlib
import pty
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

BIN, ROOT = pathlib.Path(sys.argv[1]), pathlib.Path(__file__).resolve().parents[2]
PAIRS = int(sys.argv[2]) if len(sys.argv) > 2 else 3
CASE = sys.argv[3:] or [str(ROOT / "cases/plate_entry.toml"), "--set", "end_time=0.0024", "--set", "fluid.spacing=0.02"]
ENV = dict(os.environ, OMP_WAIT_POLICY="passive", OPENBLAS_NUM_THREADS="1", OMPI_MCA_ess_singleton_isolated="1")


def get(address):
    with urllib.request.urlopen(address, timeout=30) as answer:
        return answer.read()


def page(address, stop):
    rows, frames = 0, {"fluid": 0, "structure": 0}
    while not stop.wait(0.7):
        news = json.loads(get(address + "api/news"))
        if news["tables"]["history"]["rows"] > rows:
            get(f"{address}api/table?name=history&from={rows}")
            rows = news["tables"]["history"]["rows"]
        for side, field in (("fluid", "pressure"), ("structure", "von_mises")):
            if news["frames"][side]["count"] > frames[side]:
                listed = json.loads(get(f"{address}api/frames?side={side}&from={frames[side]}"))
                frames[side] += len(listed["numbers"])
                get(f"{address}api/frame?side={side}&number={listed['numbers'][-1]}&field={field}")


def once(how, place):
    run = subprocess.Popen([BIN / "strake", "run", *CASE, "--runs", place, "--tag", "it", "--quiet", "--force"], env=ENV)
    folder = None
    while folder is None:
        folder = next((f for f in pathlib.Path(place).glob("*-it") if (f / "run.json").exists()), None)
        time.sleep(0.01)
    watcher, stop, asking = None, threading.Event(), None
    if how == "terminal":
        pid, terminal = pty.fork()
        if pid == 0:
            os.execve(BIN / "strake", ["strake", "watch", str(folder)], ENV)
        watcher = pid
        asking = threading.Thread(target=drain, args=(terminal,))
    elif how == "page":
        served = subprocess.Popen([BIN / "strake", "watch", folder, "--web"], env=ENV, stdout=subprocess.PIPE, text=True)
        said = ""
        while "http" not in said:
            said = served.stdout.readline()
        watcher = served.pid
        asking = threading.Thread(target=page, args=(re.search(r"http\S+", said).group(), stop))
    if asking:
        asking.start()
    begin = time.monotonic()
    _, status, used = os.wait4(run.pid, 0)
    wall = time.monotonic() - begin
    stop.set()
    if asking:
        asking.join()
    own = 0.0
    if watcher:
        if how == "page":
            os.kill(watcher, signal.SIGINT)
        _, _, spent = os.wait4(watcher, 0)
        own = spent.ru_utime + spent.ru_stime
    assert status == 0, status
    run_seconds = json.loads((folder / "summary.json").read_text())["seconds"]["wall"]
    return {"wall": run_seconds, "run_cpu": used.ru_utime + used.ru_stime, "watch_cpu": own, "waited": wall}


def drain(terminal):
    try:
        while os.read(terminal, 65536):
            pass
    except OSError:
        pass


with tempfile.TemporaryDirectory() as place:
    found = {how: [] for how in ("alone", "terminal", "page")}
    for _ in range(PAIRS):
        for how in found:
            found[how].append(once(how, place))
    print(f"{'':10} {'wall [s]':>9} {'run CPU [s]':>12} {'watch CPU [s]':>14} {'of the wall':>12}")
    for how, each in found.items():
        m = {key: statistics.median(one[key] for one in each) for key in each[0]}
        print(f"{how:10} {m['wall']:9.2f} {m['run_cpu']:12.2f} {m['watch_cpu']:14.3f} {100 * m['watch_cpu'] / m['wall']:10.2f} %")
    for how in ("terminal", "page"):
        pairs = [100 * (one["run_cpu"] / base["run_cpu"] - 1) for one, base in zip(found[how], found["alone"])]
        print(f"{how}: run CPU against the same run alone {', '.join(f'{p:+.1f} %' for p in pairs)}")
