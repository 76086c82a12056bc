"""Endpoints of a user: no file of the user's is removed, and one path serves one run. The socket of a dead run is
replaced, and a text that is no endpoint is refused by its key."""
import signal
import socket

from processes import *  # noqa: F403: the test's own vocabulary

CASE = ROOT / "cases" / "plate_entry.toml"
QUICK = ["--quiet", "--set", "structure.solver=rigid", "--set", "fluid.scheme.time_step=1e-5", "--set",
         "fluid.spacing=0.02", "--set", "end_time=3e-4"]


def at(endpoint, *words):
    return [CASE, *QUICK, "--set", f"coupling.endpoint={endpoint}", *words]


def what_stands_there_stays(place):
    own, link, dead = place / "own", place / "link", place / "dead"
    own.write_text("mine")
    link.symlink_to(own)
    with socket.socket(socket.AF_UNIX) as s:
        s.bind(str(dead))
    for path, kind in ((own, "a file"), (link, "a link"), (dead, "a socket"), (place, "a folder")):
        result = strake("run", *at(f"ipc://{path}", "--tag", "refused"), cwd=place)
        expect(result.returncode == 2 and f"{kind} stands there" in result.stderr,
               f"ipc://{kind}: exit {result.returncode}\n{result.stderr}")
    expect(own.read_text() == "mine" and link.is_symlink() and dead.is_socket(), "all of them stay")


def one_path_one_run(place):
    """A folder of the user's, with a name like those that the coupler makes for itself."""
    folder = place / "strake-mine"
    folder.mkdir()
    path = folder / "p"
    long = [w if w != "end_time=3e-4" else "end_time=0.5" for w in at(f"ipc://{path}", "--tag", "first")]
    first = start("run", *long, cwd=place)
    run = place / "runs" / "plate_entry-first"
    expect(wait_until(lambda: rows(run) > 3, 60), "a run at a path of the user's goes on")
    second = strake("run", *at(f"ipc://{path}", "--tag", "second"), cwd=place)
    expect(second.returncode == 2 and "another run uses it" in second.stderr,
           f"a second run at that path: exit {second.returncode}\n{second.stderr}")
    before = rows(run)
    expect(wait_until(lambda: rows(run) > before + 3, 30), "the first goes on")
    others = list(children(first.pid).values())
    os.kill(first.pid, signal.SIGKILL)
    first.communicate()
    expect(wait_until(lambda: not any(alive(pid) for pid in others), 20), "its participants end with it")
    expect(path.is_socket(), "they leave the user's folder alone")
    third = strake("run", *at(f"ipc://{path}", "--tag", "third"), cwd=place)
    expect(third.returncode == 0, f"the next run replaces the dead one's socket: exit {third.returncode}\n{third.stderr}")
    expect(list(folder.iterdir()) == [], f"and leaves nothing: {list(folder.iterdir())}")


def no_endpoint(place):
    for endpoint in ("tcp://127.0.0.1:99999", "tcp://127.0.0.1:0", "tcp://127.0.0.1:-1", "tcp://1.2.3.4", "tcp://:5555",
                     "tcp://a b:5555", "udp://127.0.0.1:5555", "inproc://a", "ipc://", "ipc:///" + "a" * 120):
        for command in ("check", "run"):
            result = strake(command, *(w for w in at(endpoint) if w != "--quiet" or command == "run"), cwd=place)
            expect(result.returncode == 3 and "coupling.endpoint" in result.stderr,
                   f"{command} with {endpoint[:30]}: exit {result.returncode} {result.stderr.splitlines()[:1]}")
    missing = strake("run", *at(f"ipc://{place}/none/p"), cwd=place)
    expect(missing.returncode == 2 and "cannot be entered" in missing.stderr, f"no such folder: {missing.stderr}")


with folder() as name:
    place = pathlib.Path(name)
    what_stands_there_stays(place)
    one_path_one_run(place)
    no_endpoint(place)
finish()
