"""The end of the coupler ends its participants, whatever they compute."""
import os
import sys
import threading

GONE = 5     # exit code of a solver whose coupler has ended (proto/README.md, "Exit codes")
BEAT = 0.1   # [s] between two tests of the coupler's process


def coupler_process():
    """Returns the id of the coupler's process; 0 where this program was started by hand."""
    text = os.environ.get("STRAKE_COUPLER", "")
    return int(text) if text.isdigit() else 0


def start_of(pid):
    """When that process began, in the kernel's ticks; None where it has ended."""
    try:
        with open(f"/proc/{pid}/stat", "rb") as file:
            fields = file.read().rsplit(b")", 1)[1].split()
    except (OSError, IndexError):
        return None
    return None if fields[0] in (b"Z", b"X") else fields[19]


def end(name):
    sys.stderr.write(f"{name}: the coupler is gone, so this process ends (exit {GONE})\n")
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            pass
    os._exit(GONE)  # other threads may compute for long


def watch(name):
    """Ends this process within BEAT of the coupler's end, by a thread; True where the coupler started this program."""
    pid = coupler_process()
    if not pid:
        return False
    began = start_of(pid)

    def look(wait):
        while start_of(pid) == began:
            if wait.wait(BEAT):
                return
        end(name)

    if began is None:
        end(name)
    threading.Thread(target=look, args=(threading.Event(),), name="strake: coupler alive", daemon=True).start()
    return True
