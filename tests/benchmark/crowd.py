"""Strangers at the endpoint of a run: thousands of connections of every kind, with few descriptors for the coupler. The
run must end as without them, with the same results, and its memory must stay bounded.

usage: crowd.py BIN [--short] [--connections N]
BIN is the folder of the programs. --short is the version of ctest: one kind and one limit for each transport."""
import argparse
import os
import pathlib
import re
import resource
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
CASE = ROOT / "cases" / "plate_entry.toml"
QUICK = ["structure.solver=rigid", "fluid.scheme.time_step=1e-5", "fluid.spacing=0.02"]
RESULTS = ("history.csv", "iterations.csv")
MEMORY = 200 * 1024  # [KiB] a crowd may add at most
BATCH = 400          # connections that each part of the crowd keeps open at once
READY = b"\x04\x1c\x05READY\x0bSocket-Type\0\0\0\x06DEALER"  # ZMTP 3.0 (RFC 23)
GREETING = b"\xff" + bytes(8) + b"\x7f\x03\x00NULL" + bytes(48)


def silence(connection):
    pass


def garbage(connection):
    connection.sendall(b"\xff" * 300 + b"nonsense" * 40)


def web(connection):
    connection.sendall(b"GET / HTTP/1.1\r\nHost: here\r\n\r\n")


def half_greeting(connection):
    connection.sendall(GREETING[:11])


def greeting(connection):
    connection.sendall(GREETING + READY)


def endless(connection):
    """Parts of one byte, more to follow: a message that never becomes whole."""
    connection.sendall(GREETING + READY)
    heard = 0
    while heard < len(GREETING) + 2:  # the coupler's own greeting and READY: it has taken ours
        heard += len(connection.recv(256)) or 256
    connection.sendall(b"\x01\x01a" * 400_000)


KINDS = {"silence": silence, "garbage": garbage, "web": web, "half greeting": half_greeting, "greeting": greeting,
         "endless": endless, "storm": None}


class Crowd:
    """Connects in batches, and keeps one open while it opens the next; `storm` closes each connection at once."""
    GATES = 4

    def __init__(self, endpoint, kind, number):
        self.endpoint, self.kind, self.number, self.opened, self.over = endpoint, kind, number // self.GATES, 0, False
        self.threads = [threading.Thread(target=self.come, daemon=True) for _ in range(self.GATES)]
        for thread in self.threads:
            thread.start()

    def leave(self):
        self.over = True
        for thread in self.threads:
            thread.join()

    def knock(self):
        if self.endpoint.startswith("tcp://"):
            address = ("127.0.0.1", int(self.endpoint.rsplit(":", 1)[1]))
            connection = socket.socket(socket.AF_INET)
        else:
            path = self.endpoint[len("ipc://"):]
            address = "\0" + path[1:] if path.startswith("@") else path
            connection = socket.socket(socket.AF_UNIX)
        # Python's own timeout would give up where the queue is full; the kernel's waits for a place in it.
        for limit in (socket.SO_SNDTIMEO, socket.SO_RCVTIMEO):
            connection.setsockopt(socket.SOL_SOCKET, limit, struct.pack("ll", 0, 300_000))
        try:
            connection.connect(address)
            self.opened += 1
            if KINDS[self.kind]:
                KINDS[self.kind](connection)
        except OSError:  # turned away
            pass
        return connection

    def come(self):
        held, limit = [], time.monotonic() + 25
        for _ in range(self.number):
            if self.over or time.monotonic() > limit:
                break
            held.append(self.knock())
            if self.kind == "storm":
                held.pop().close()
            if len(held) >= BATCH:
                for connection in held[:BATCH // 2]:
                    connection.close()
                del held[:BATCH // 2]
        while not self.over:
            time.sleep(0.05)
        for connection in held:
            connection.close()


def limited(descriptors):
    def limit():
        resource.setrlimit(resource.RLIMIT_NOFILE, (descriptors, descriptors))
    return limit


def endpoint_of(run, process):
    """The value in run.json."""
    for _ in range(1000):
        try:
            found = re.search(r'"coupling": "((?:tcp|ipc)://[^"]+)"', (run / "run.json").read_text())
            if found:
                return found.group(1)
        except OSError:
            pass
        if process.poll() is not None:
            break
        time.sleep(0.01)
    return None


def await_socket(path):
    for _ in range(1000):
        with socket.socket(socket.AF_UNIX) as connection:
            if connection.connect_ex("\0" + path[1:] if path.startswith("@") else path) == 0:
                return
        time.sleep(0.005)


def peak_memory(pid):
    try:
        return int(re.search(r"VmHWM:\s+(\d+)", pathlib.Path(f"/proc/{pid}/status").read_text()).group(1))
    except (OSError, AttributeError):
        return 0


def couple(bins, place, tag, endpoint, keys, descriptors, kind, number, end_time):
    """One run. Returns exit code, folder, seconds, peak memory [KiB], connections that were opened, messages."""
    sets = [*QUICK, f"end_time={end_time}", f"coupling.endpoint={endpoint}", *([f"coupling.keys={keys}"] if keys else [])]
    words = [str(bins / "strake"), "run", str(CASE), "--tag", tag, "--quiet"]
    for s in sets:
        words += ["--set", s]
    run = place / "runs" / f"plate_entry-{tag}"
    start = time.monotonic()
    errors = open(place / f"{tag}.err", "w+")
    process = subprocess.Popen(words, cwd=place, stdout=subprocess.DEVNULL, stderr=errors,
                               env=dict(os.environ, NO_COLOR="1", OMP_NUM_THREADS="1"), preexec_fn=limited(descriptors))
    crowd, peak = None, 0
    if kind:
        known = endpoint if not endpoint.endswith("*") else endpoint_of(run, process)
        if known and known.startswith("ipc://"):
            await_socket(known[len("ipc://"):])
        if known:
            crowd = Crowd(known, kind, number)
    while process.poll() is None and time.monotonic() - start < 60:
        peak = max(peak, peak_memory(process.pid))
        time.sleep(0.01)
    if process.poll() is None:
        process.send_signal(signal.SIGTERM)
        process.wait(20)
    seconds = time.monotonic() - start
    if crowd:
        crowd.leave()
    errors.seek(0)
    return process.returncode, run, seconds, peak, crowd.opened if crowd else 0, errors.read()


def same(run, reference):
    files = [*RESULTS, *(p.relative_to(reference) for p in sorted((reference / "interface").rglob("*")) if p.is_file())]
    return [f for f in files if not (run / f).exists() or (run / f).read_bytes() != (reference / f).read_bytes()]


def settings(short, place):
    transports = {"tcp": "tcp://127.0.0.1:*", "ipc @": f"ipc://@strake-crowd-{os.getpid()}", "ipc": f"ipc://{place}/p"}
    if short:
        return [("tcp", transports["tcp"], False, 128, "greeting"), ("ipc @", transports["ipc @"], False, 128, "silence"),
                ("ipc", transports["ipc"], False, 128, "endless")]
    return [(name, endpoint, keys, limit, kind) for name, endpoint in transports.items() for keys in (False, True)
            for limit in (128, 512, 1024, 4096) for kind in KINDS]


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("bins", type=pathlib.Path)
    arguments.add_argument("--short", action="store_true")
    arguments.add_argument("--connections", type=int, default=5000)
    arguments.add_argument("--end-time", default="0.006")
    arguments.add_argument("--only", default="", help="words that the line of a setting must have")
    given = arguments.parse_args()
    given.bins = given.bins.resolve()
    hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, 8192), hard))
    number = 1500 if given.short else given.connections
    end_time = "0.0015" if given.short else given.end_time
    failed = 0
    with tempfile.TemporaryDirectory(prefix="strake-test-") as name:
        place = pathlib.Path(name)
        subprocess.run([str(given.bins / "strake"), "keys", "keys"], cwd=place, check=True, stdout=subprocess.DEVNULL)
        code, reference, alone, memory, _, errors = couple(given.bins, place, "alone", "ipc", None, 4096, None, 0, end_time)
        if code:
            sys.exit(f"the run without a crowd: exit {code}\n{errors}")
        print(f"without a crowd: {alone:.1f} s, {memory / 1024:.0f} MB\n")
        print("transport  keys  descriptors  kind            opened  exit       s    MB   results", flush=True)
        for k, (transport, endpoint, keys, limit, kind) in enumerate(settings(given.short, place)):
            line = f"{transport:9}  {'yes' if keys else 'no':4}  {limit:11}  {kind:13}"
            if not all(word in line for word in given.only.split(",")):
                continue
            code, run, seconds, peak, opened, errors = couple(
                given.bins, place, f"{k}", endpoint, place / "keys" if keys else None, limit, kind, number, end_time)
            different = same(run, reference)
            bad = code != 0 or bool(different) or peak - memory > MEMORY
            failed += bad
            print(f"{line}  {opened:7}  {code:4}  {seconds:6.1f}  {peak / 1024:4.0f}   "
                  f"{'equal' if not different else 'differ: ' + ', '.join(map(str, different))}{'  FAIL' if bad else ''}", flush=True)
            if bad:
                print(errors)
    print(f"{failed} failed")
    sys.exit(failed > 0)


main()
