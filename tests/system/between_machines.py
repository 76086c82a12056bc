"""A run whose participants are started by hand over tcp with encryption keys, as on several machines, all on loopback.
Strangers at the port disturb no participant. A client with a wrong key or token gets a message and ends. The results
are those of an ordinary run."""
import json
import re
import shlex
import socket
import stat

from processes import *  # noqa: F403: the test's own vocabulary

CASE = ROOT / "cases" / "plate_entry.toml"
QUICK = ["--set", "structure.solver=rigid", "--set", "fluid.scheme.time_step=1e-5", "--set", "end_time=3e-4"]
GOLDEN = ROOT / "tests" / "text" / "network.txt"
said = {}  # name → what a program printed


def mode(path):
    return stat.S_IMODE(path.stat().st_mode)


def words_of(text, place):
    """What a program printed, without what differs from run to run."""
    text = re.sub(r"^\[[-0-9 :.]+\] ", "", text, flags=re.M)  # the log's clock
    text = re.sub(r"^\[info\].*\n", "", text, flags=re.M)
    text = re.sub(r"127\.0\.0\.1:\d+", "127.0.0.1:PORT", text)
    return text.replace(str(ROOT) + "/", "").replace(str(place) + "/", "")


def commands(run, sides, process):
    """Side → command line, once run.json contains them all."""
    def read():
        try:
            participants = json.loads((run / "run.json").read_text()).get("participants", {})
        except (OSError, ValueError):
            return {}
        return {s: p["start_by_hand"] for s, p in participants.items() if "start_by_hand" in p}
    wait_until(lambda: len(read()) == len(sides) or process.poll() is not None, 60)
    expect(set(read()) == set(sides), f"run.json holds the command lines of {sides}")
    return read()


def by_hand(line, cwd, **changes):
    for name, value in changes.items():
        line = re.sub(rf"\b{name}=\S+ ", f"{name}={value} " if value is not None else "", line)
    return subprocess.Popen(["sh", "-c", line], cwd=cwd, env=ENV, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                            text=True)


def ended(process, name, place):
    try:
        said[name] = words_of(process.communicate(timeout=20)[0], place)
    except subprocess.TimeoutExpired:
        process.kill()
        expect(False, f"{name}: the participant is still waiting")
        said[name] = words_of(process.communicate()[0], place)
    return process.returncode


def strangers(port):
    """What stands at an open port sooner or later. Returns the sockets that stay open."""
    address = ("127.0.0.1", port)
    for words in (b"GET / HTTP/1.1\r\nHost: here\r\n\r\n", b"\xff" * 300, b"\0" * 64, b""):
        with socket.create_connection(address) as knock:
            knock.sendall(words)
    for _ in range(500):
        with socket.create_connection(address) as knock:
            knock.sendall(b"nonsense")
    return [socket.create_connection(address) for _ in range(50)]


def keys_are_private(place):
    made = strake("keys", "keys", cwd=place)
    said["strake keys"] = words_of(made.stdout, place)
    expect(made.returncode == 0 and mode(place / "keys") == 0o700, "strake keys makes a folder of mode 0700")
    expect(all(mode(file) == 0o600 for file in (place / "keys").iterdir()), "and files of mode 0600")
    again = strake("keys", "keys", cwd=place)
    expect(again.returncode == 2, f"keys that exist are left alone: exit {again.returncode}")
    strake("keys", "others", cwd=place)


def words_before_a_run(place):
    """What is refused before anything starts."""
    for name, code, sets in [
        ("an endpoint beyond this machine without keys", 3, ["coupling.endpoint=tcp://0.0.0.0:5555"]),
        ("plain words that are not those", 3, ["coupling.endpoint=tcp://0.0.0.0:5555", "coupling.unencrypted=yes"]),
        ("an endpoint that is none", 3, ["coupling.endpoint=127.0.0.1:5555"]),
        ("a folder of keys that does not exist", 3, [f"coupling.keys={place}/none"]),
    ]:
        result = strake("run", CASE, *QUICK, *(word for s in sets for word in ("--set", s)), cwd=place)
        said[name] = words_of(result.stderr, place)
        expect(result.returncode == code, f"{name}: exit {result.returncode}, expected {code}")
    result = strake("run", ROOT / "cases" / "still_tank.toml", "--attach", "structure", cwd=place)
    said["--attach of a side that the case does not have"] = words_of(result.stderr, place)
    expect(result.returncode == 2, f"--attach structure without a structure: exit {result.returncode}")


def run_by_hand(place, reference):
    """Both participants by hand, from another folder, with keys; strangers and wrong ones come first."""
    other = place / "elsewhere"
    other.mkdir()
    process = start("run", CASE, *QUICK, "--set", "coupling.endpoint=tcp://127.0.0.1:*", "--set",
                    f"coupling.keys={place}/keys", "--attach", "both", "--tag", "hand", cwd=place)
    run = place / "runs" / "plate_entry-hand"
    started, open_sockets = [], []
    try:
        lines = commands(run, ["fluid", "structure"], process)
        expect(mode(run / "run.json") == 0o600, "run.json, which holds the token, is private")
        port = int(re.search(r"127\.0\.0\.1:(\d+)", lines["fluid"]).group(1))
        open_sockets = strangers(port)
        wrong = {
            "a key of another folder": ({"STRAKE_KEY": place / "others" / "structure.key"}, 2),
            "the key of another participant": ({"STRAKE_KEY": place / "keys" / "fluid.key"}, 2),
            "no key": ({"STRAKE_KEY": None}, 2),
            "a key file that does not exist": ({"STRAKE_KEY": place / "keys" / "hull.key"}, 2),
            "a wrong token": ({"STRAKE_TOKEN": "00" * 16}, 5),
            "a token that is none": ({"STRAKE_TOKEN": "secret"}, 2),
        }
        for name, (changes, code) in wrong.items():
            code_found = ended(by_hand(lines["structure"], other, **changes), name, place)
            expect(code_found == code, f"{name}: the participant ends with {code_found}, expected {code}")
        changed = place / "others" / "structure.key"  # the right coupler, a key that it does not list
        ours = dict(re.findall(r'^(\S+) = "(.*)"$', (place / "keys" / "structure.key").read_text(), flags=re.M))
        changed.write_text(re.sub(r'coupler = ".*"', lambda _: f'coupler = "{ours["coupler"]}"', changed.read_text()))
        name = "a key that the coupler does not list"
        code_found = ended(by_hand(lines["structure"], other, STRAKE_KEY=changed), name, place)
        expect(code_found == 2, f"{name}: the participant ends with {code_found}, expected 2")

        started = [by_hand(lines[side], other) for side in ("structure", "fluid")]
        wait_until(lambda: rows(run) >= 3 or process.poll() is not None, 60)
        try:
            open_sockets += strangers(port)
        except ConnectionError:
            expect(process.poll() == 0, "the port is closed because the run is done")
        errors = process.communicate(timeout=120)[1]
        expect(process.returncode == 0, f"the run by hand ends with {process.returncode}\n{errors}")
        for side, one in zip(("structure", "fluid"), started):
            one.communicate(timeout=20)
            expect(one.returncode == 0, f"{side}: ends with {one.returncode}")
        log = (run / "coupler.log").read_text()
        for told in ("did not greet as ZeroMQ does", "has the key of another coupler",
                     "127.0.0.1 holds no key of this run", "does not know the token"):
            expect(told in log, f"coupler.log: {told}")
        expect(log.count("\n") < 100, f"a crowd of 1000 makes few lines ({log.count(chr(10))})")
        expect("STRAKE_TOKEN" not in log, "the token stands in no log")
        for name in ("history.csv", "iterations.csv"):
            expect((run / name).read_bytes() == (reference / name).read_bytes(), f"{name} is that of an ordinary run")
    finally:
        for one in started:
            end(one)
        for one in open_sockets:
            one.close()
        end(process)


def launched_with_keys(place, reference):
    """The coupler starts the fluid itself, with its key; the structure comes by hand without any --case of its own."""
    process = start("run", CASE, *QUICK, "--set", "coupling.endpoint=tcp://127.0.0.1:*", "--set",
                    f"coupling.keys={place}/keys", "--attach", "structure", "--tag", "half", cwd=place)
    run = place / "runs" / "plate_entry-half"
    one = by_hand(commands(run, ["structure"], process)["structure"], place)
    errors = process.communicate(timeout=120)[1]
    expect(process.returncode == 0, f"one by hand, one started: exit {process.returncode}\n{errors}")
    one.communicate(timeout=20)
    expect((run / "history.csv").read_bytes() == (reference / "history.csv").read_bytes(),
           "one by hand, one started: history.csv is that of an ordinary run")


def foreign_program(place):
    """A user's program that this machine does not have: its command line is printed all the same."""
    case = place / "foreign.toml"
    case.write_text('title = "a program of another machine"\nend_time = 1e-3\n[fluid]\nsolver = "none"\n'
                    '[structure]\nsolver = "./not/here"\n[coupling]\nsurface.window = 1e-4\n')
    result = strake("run", case, cwd=place)
    said["a program that does not exist"] = words_of(result.stderr, place)
    expect(result.returncode == 3, f"a program that does not exist: exit {result.returncode}")
    process = start("run", case, "--attach", "structure", cwd=place)
    words = shlex.split(commands(place / "runs" / "foreign", ["structure"], process)["structure"])
    program = words.index(str(place / "not" / "here"))
    settings = dict(word.split("=", 1) for word in words[:program])
    toy = subprocess.Popen([str(BIN.parent / "tests" / "toy_participant"), *words[program + 1:]], cwd="/",
                           env=dict(ENV, **settings), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    errors = process.communicate(timeout=60)[1]
    expect(process.returncode == 0, f"a foreign program by hand: exit {process.returncode}\n{errors}")
    toy.communicate(timeout=20)
    expect(toy.returncode == 0 and rows(place / "runs" / "foreign") == 10, "a foreign program by hand takes ten windows")


def nobody_comes(place):
    result = strake("run", CASE, *QUICK, "--attach", "structure", "--set", "coupling.attach_within=1", "--tag", "alone",
                    cwd=place)
    said["nobody comes"] = re.sub(r"within \S+ s", "within N s", words_of(result.stderr, place))
    expect(result.returncode == 5, f"nobody comes: exit {result.returncode}")


def texts_are_those_stored():
    text = GOLDEN.read_text()
    head = text[:text.find("==== ")]
    stored = dict(block.split("\n", 1) for block in text.split("==== ")[1:])
    for name, words in said.items():
        expect(stored.get(name) == words, f"text of {name!r} as stored" +
               ("" if stored.get(name) == words else f"\n{words}--- stored\n{stored.get(name)}"))
    if "STRAKE_WRITE_TEXTS" in os.environ:
        GOLDEN.write_text(head + "".join(f"==== {name}\n{words}" for name, words in said.items()))


with folder() as place:
    place = pathlib.Path(place)
    keys_are_private(place)
    words_before_a_run(place)
    ordinary = strake("run", CASE, *QUICK, cwd=place)
    expect(ordinary.returncode == 0, f"an ordinary run: exit {ordinary.returncode}\n{ordinary.stderr}")
    reference = place / "runs" / "plate_entry"
    run_by_hand(place, reference)
    launched_with_keys(place, reference)
    foreign_program(place)
    nobody_comes(place)
texts_are_those_stored()
finish()
