"""Output of `strake run`: a bar on a terminal, plain lines in a pipe, JSON for programs, little with --quiet."""
import csv
import fcntl
import json
import math
import pty
import re
import signal
import struct
import termios
import threading

from processes import *  # noqa: F403: the test's own vocabulary

CASE = ROOT / "cases" / "plate_entry.toml"
RIGID = [CASE, "--set", "structure.solver=rigid", "--set", "fluid.scheme.time_step=1e-5"]
QUICK, SHORT = [*RIGID, "--set", "end_time=2.3e-3"], [*RIGID, "--set", "end_time=1.2e-3"]
BAR = re.compile(r"^ *\d+ % \[")
END = b"\0"  # written to the terminal after the last letter of the command


class Screen:
    """A terminal of some width that understands what the bar uses: new lines, cursor up, erase below, colours."""

    def __init__(self, width):
        self.width, self.rows, self.row, self.column = width, [""], 0, 0
        self.bars, self.widest, self.unknown, self.rest = [], -width, [], ""

    def take(self, text):
        text, self.rest = self.rest + text, ""
        at = 0
        while at < len(text):
            if text[at] == "\033":
                found = re.match(r"\033\[(\d*)([A-Za-z])", text[at:])
                if not found:
                    self.rest = text[at:]
                    return
                self.escape(found[2], int(found[1] or 1))
                at += found.end()
                continue
            self.put(text[at])
            at += 1

    def escape(self, what, number):
        if what == "A":
            self.row = max(0, self.row - number)
        elif what == "J":
            self.rows = self.rows[:self.row + 1]
            self.rows[self.row] = self.rows[self.row][:self.column]
        elif what != "m":
            self.unknown.append(what)

    def put(self, letter):
        if letter == "\r":
            self.column = 0
        elif letter == "\n":
            if BAR.match(self.rows[self.row]):
                self.bars.append((self.rows[self.row], time.monotonic()))
                self.widest = max(self.widest, len(self.rows[self.row]) - self.width)
            self.row, self.column = self.row + 1, 0
            if self.row == len(self.rows):
                self.rows.append("")
        else:
            line = self.rows[self.row]
            self.rows[self.row] = line[:self.column] + letter + line[self.column + 1:]
            self.column += 1

    def text(self):
        return "\n".join(self.rows)


def resize(terminal, width):
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 40, width, 0, 0))


def on_terminal(words, width, cwd, then=None):
    """Exit code and screen of a command; `then(process, screen, terminal)` is called while it runs."""
    terminal, end_of_process = pty.openpty()
    resize(terminal, width)
    environment = dict(ENV, TERM="xterm", LANG="C.UTF-8", LC_ALL="C.UTF-8")
    process = subprocess.Popen([str(BIN / "strake"), *map(str, words)], cwd=cwd, env=environment, stdin=subprocess.DEVNULL,
                               stdout=end_of_process, stderr=end_of_process)

    # This end of the terminal stays open. Else what is not read yet may be lost when the command closes its own (seen once).
    def mark_end():
        process.wait()
        os.write(end_of_process, END)

    waiting = threading.Thread(target=mark_end)
    waiting.start()
    screen, letters = Screen(width), b""
    while not letters.endswith(END):
        letters += os.read(terminal, 65536)
        whole = letters.removesuffix(END).decode("utf-8", errors="ignore")
        if whole.encode() == letters.removesuffix(END):  # no letter is cut in two
            screen.take(whole)
            letters = letters[len(whole.encode()):]
        if then:
            then(process, screen, terminal)
    waiting.join()
    os.close(end_of_process)
    os.close(terminal)
    return process.wait(timeout=60), screen


def bar_on_a_terminal(place):
    for width in (100, 60):
        code, screen = on_terminal(["run", *SHORT, "--tag", f"wide-{width}"], width, place)
        run = place / "runs" / f"plate_entry-wide-{width}"
        expect(code == 0, f"{width} columns: exit {code}\n{screen.text()}")
        expect(len(screen.bars) >= 2 and not screen.unknown, f"{width} columns: {len(screen.bars)} bars were drawn")
        expect(screen.widest < 0, f"{width} columns: no row of the bar is wider")
        expect(not any(BAR.match(row) for row in screen.rows), f"{width} columns: the bar is gone at the end")
        parts = [int(bar.split("%")[0]) for bar, _ in screen.bars]
        expect(parts == sorted(parts) and 0 <= parts[0] and parts[-1] <= 100, f"{width} columns: parts {parts}")
        drawn = screen.bars[-1][1] - screen.bars[0][1]
        expect((len(screen.bars) - 1) <= 5 * drawn + 2, f"{width} columns: {len(screen.bars)} bars in {drawn:.2f} s")
        text = screen.text()
        for word in ("done  120 windows", "p_mid impulse", f"strake report runs/{run.name}", "history.csv"):
            expect(word in text, f"{width} columns: the closing summary says {word}")
        frames = len(list((run / "frames").glob("fluid-*.h5")))
        rows = [row for row in screen.rows if re.match(r"^ +\d+  0\.00", row)]
        expect(len(rows) >= frames - 1 and all(len(row) < width for row in rows),
               f"{width} columns: {len(rows)} lines for {frames} frames, none of them broken")


def terminal_made_narrow(place):
    def shrink(process, screen, terminal):
        if len(screen.bars) == 3 and screen.width == 110:
            screen.width, screen.widest = 44, -44
            resize(terminal, 44)
            shrink.from_bar = len(screen.bars)

    shrink.from_bar = 0
    code, screen = on_terminal(["run", *QUICK, "--tag", "narrow"], 110, place, shrink)
    after = [bar for bar, _ in screen.bars[shrink.from_bar + 1:]]  # one may be on its way
    expect(code == 0 and after and all(len(bar) < 44 for bar in after), f"made narrow: {len(after)} bars after it fit")


def interrupted_on_a_terminal(place):
    def stop(process, screen, terminal):
        if len(screen.bars) >= 3 and not stop.sent:
            stop.sent = True
            process.send_signal(signal.SIGINT)

    stop.sent = False
    code, screen = on_terminal(["run", *QUICK, "--tag", "stopped"], 90, place, stop)
    expect(code == 130, f"interrupted: exit {code}")
    expect(not any(BAR.match(row) for row in screen.rows), "interrupted: the bar is gone")
    expect("with --resume" in screen.text() and "the state is saved" in screen.text(), f"interrupted: it says how to go on\n{screen.text()}")
    whole = [row for row in screen.rows if "the state is saved" in row]
    expect(len(whole) == 1 and not BAR.search(whole[0]), "interrupted: the error stands on a line of its own")


def plain_in_a_pipe(place):
    result = strake("run", *SHORT, "--tag", "pipe", cwd=place)
    control = sorted({hex(ord(c)) for c in result.stdout + result.stderr if ord(c) < 32 and c != "\n"})
    expect(result.returncode == 0 and not control, f"a pipe gets no control characters: {control}")
    expect(" % [" not in result.stdout and "done  120 windows" in result.stdout, "a pipe gets no bar")


def quiet(place):
    result = strake("run", *SHORT, "--tag", "quiet", "--quiet", cwd=place)
    lines = result.stdout.splitlines()
    expect(result.returncode == 0 and lines, f"--quiet: exit {result.returncode}\n{result.stderr}")
    expect(all(re.match(r"(pass|FAIL|not reached|warning) ", line) for line in lines), f"--quiet: verdicts and warnings alone\n{result.stdout}")


def json_for_programs(place):
    result = strake("run", *QUICK, "--tag", "json", "--json", cwd=place)
    run = place / "runs" / "plate_entry-json"
    said = [json.loads(line) for line in result.stdout.splitlines()]
    kinds = [line["kind"] for line in said]
    expect(result.returncode == 0 and kinds[0] == "start" and kinds[-1] == "end", f"--json: exit {result.returncode}, {set(kinds)}")
    reference = (ROOT / "proto" / "RESULTS.md").read_text()
    expect(all(f"`{kind}`" in reference for kind in set(kinds)), "--json: proto/RESULTS.md names every kind")
    rows = list(csv.reader((run / "history.csv").open()))
    names = [name.rsplit(" [", 1)[0] for name in rows[0]]
    expect([f"{c['name']} [{c['unit']}]" for c in said[0]["columns"]] == rows[0], "--json: start names the columns of history.csv")
    by_window = {int(float(row[0])): row for row in rows[1:]}
    windows = [line for line in said if line["kind"] == "window"]
    frames = len(list((run / "frames").glob("fluid-*.h5")))
    expect(frames - 1 <= len(windows) <= frames + 1, f"--json: {len(windows)} windows for {frames} frames")

    def same(value, cell):
        return cell == "" if value is None else math.isclose(value, float(cell), rel_tol=0, abs_tol=0)

    wrong = [(line["window"], name) for line in windows for name, cell in zip(names, by_window[line["window"]])
             if not same(line["values"][name], cell)]
    expect(windows and not wrong, f"--json: the values are those of history.csv {wrong[:3]}")
    summary = json.loads((run / "summary.json").read_text())
    expect(said[-1]["summary"] == summary and said[-1]["exit_code"] == 0, "--json: the end carries summary.json")
    told = [line["verdict"] for line in said if line["kind"] == "verdict"]
    expect(told and all(v in summary["compare"] for v in told), "--json: verdicts are those of summary.json")
    refused = strake("run", CASE, "--set", "fluid.spacng=1", "--json", cwd=place)
    error = json.loads(refused.stdout.splitlines()[-1])
    expect(refused.returncode == 3 and error["kind"] == "error" and error["exit_code"] == 3 and "spacng" in error["problem"],
           f"--json: an error is a line too\n{refused.stdout}{refused.stderr}")


with folder() as place:
    place = pathlib.Path(place)
    bar_on_a_terminal(place)
    terminal_made_narrow(place)
    interrupted_on_a_terminal(place)
    plain_in_a_pipe(place)
    quiet(place)
    json_for_programs(place)
finish()
