"""`strake watch` beside a run. In a pipe it ends with the run; on a terminal it restores the screen. Its page is only for
readers with its address, and neither disturbs the run."""
import json
import os
import pty
import re
import select
import signal
import urllib.error
import urllib.request

from processes import *  # noqa: F403: the test's own vocabulary

CASE = ROOT / "cases" / "plate_entry.toml"
QUICK = ["--set", "structure.solver=rigid", "--set", "fluid.scheme.time_step=1e-5", "--set", "fluid.spacing=0.02"]


def run_and_watch(place):
    run = start("run", CASE, *QUICK, "--set", "end_time=0.002", "--quiet", cwd=place)
    folder = place / "runs" / "plate_entry"
    wait_until(lambda: (folder / "run.json").exists(), 30)
    watch = start("watch", cwd=place)  # the newest
    out, err = watch.communicate(timeout=120)
    expect(run.wait(60) == 0, "the run that was watched ends well")
    expect(watch.returncode == 0, f"in a pipe watch exits with the run's code: {watch.returncode}\n{err}")
    expect("\033" not in out and "\r" not in out, "in a pipe there are no control characters")
    expect(re.search(r"starting: no window is done yet|\n  running\n", out), f"it says that the run goes on\n{out}")
    expect(re.search(r"\nfinished  window 200   t 2 ms of 2 ms", out), "its last lines say that the run has finished")
    last = (folder / "history.csv").read_text().splitlines()[-1].split(",")
    expect(re.search(rf"\n +{last[0]} +0\.002000 ", out), "the last row of the table is the last window")
    before = {f: f.stat().st_mtime_ns for f in folder.rglob("*")}
    again = strake("watch", folder, cwd=place)
    expect(again.returncode == 0 and "finished  window 200" in again.stdout, "a finished run is shown and left")
    expect(before == {f: f.stat().st_mtime_ns for f in folder.rglob("*")}, "watching leaves the run's files alone")
    return folder


def killed(place):
    run = start("run", CASE, *QUICK, "--tag", "killed", "--quiet", cwd=place)
    folder = place / "runs" / "plate_entry-killed"
    wait_until(lambda: rows(folder) > 3, 60)
    watch = start("watch", folder, cwd=place)
    time.sleep(1)
    end(run)
    out, _ = watch.communicate(timeout=60)
    expect(watch.returncode == 5, f"watch of a killed run exits 5: {watch.returncode}")
    expect("killed" in out and "no end was recorded" in out, "and says that it was killed")


def refused(place, folder):
    for words, told in ((["watch", "runs/none"], "there is no such run folder"),
                        (["watch", folder / "history.csv"], "is a file, not the folder of a run"),
                        (["watch", place / "runs"], "is not the folder of a run"),
                        (["watch", "--runs", place / "none"], "there is no run in the folder"),
                        (["watch", "runs/none", "--web"], "there is no such run folder"),
                        (["watch", folder, "--web", "--bind", "203.0.113.9"], "is no address of this machine"),
                        (["watch", folder, "--port", "8000"], "--web")):
        result = strake(*words, cwd=place)
        expect(result.returncode in (2, 3) and told in result.stderr, f"watch {words[1:]}: {result.stderr.strip()}")


def on_terminal(place):
    run = start("run", CASE, *QUICK, "--tag", "terminal", "--quiet", cwd=place)
    folder = place / "runs" / "plate_entry-terminal"
    wait_until(lambda: rows(folder) > 3, 60)
    pid, terminal = pty.fork()
    if pid == 0:
        os.chdir(place)
        os.execve(BIN / "strake", ["strake", "watch", str(folder)], dict(ENV, COLUMNS="80"))
    seen, asked = b"", False
    limit = time.monotonic() + 60
    while time.monotonic() < limit:
        if select.select([terminal], [], [], 0.2)[0]:
            try:
                data = os.read(terminal, 65536)
            except OSError:  # it is gone
                break
            if not data:
                break
            seen += data
        if b"running" in seen and not asked:
            os.write(terminal, b"q")
            asked = True
    code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    expect(asked and code == 0, f"on a terminal q ends watching: exit {code}")
    expect(seen.count(b"\033[?1049h") == 1 and seen.count(b"\033[?1049l") == 1, "the screen is given back")
    expect(seen.count(b"\033[?25l") == seen.count(b"\033[?25h") == 1, "with its cursor")
    expect(run.poll() is None or rows(folder) > 2900, "the run goes on")
    end(run)


def get(address, host=None):
    request = urllib.request.Request(address, headers={"Host": host} if host else {})
    try:
        with urllib.request.urlopen(request, timeout=10) as answer:
            return answer.status, answer.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode()


def page(place, folder):
    watch = start("watch", folder, "--web", cwd=place)
    said = ""
    while "http://" not in said:
        said += watch.stdout.readline()
    address = re.search(r"http://\S+", said).group()
    expect(re.fullmatch(r"http://127\.0\.0\.1:\d+/[0-9a-f]{32}/", address), f"the page's address: {address}")
    status, text = get(address)
    expect(status == 200 and "<title>strake watch</title>" in text, "the page is served")
    status, text = get(address + "api/news")
    news = json.loads(text)
    expect(status == 200 and news["state"] == "finished" and news["window"] == 200, "and the news of the run")
    expect(news["frames"]["fluid"]["count"] == 21, f"and its frames, with that at t = 0: {news['frames']}")
    wrong = address[:-2] + ("0" if address[-2] != "0" else "1") + "/"
    status, text = get(wrong)
    expect(status == 403 and "holds no valid token" in text, f"a wrong token: {status} {text.strip()}")
    status, text = get(address, host="elsewhere.example")
    expect(status == 403 and "not served under that name" in text, f"another host's name: {status} {text.strip()}")
    expect(get(address.replace(address.split("/")[3] + "/", ""))[0] == 403, "no token at all")
    watch.send_signal(signal.SIGINT)
    expect(watch.wait(10) == 0, "Ctrl-C ends it, exit 0")


with folder() as name:
    place = pathlib.Path(name)
    finished = run_and_watch(place)
    page(place, finished)
    refused(place, finished)
    killed(place)
    on_terminal(place)
finish()
