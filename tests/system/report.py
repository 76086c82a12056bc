"""Pictures and the report. They show what the run wrote, the page is complete by itself, and a damaged run still gives
one."""
import html.parser
import json
import math
import re
import shutil
import struct
import xml.etree.ElementTree
import zlib

from processes import *  # noqa: F403: the test's own vocabulary

CASE = ROOT / "cases" / "plate_entry.toml"
QUICK = ["--set", "fluid.scheme.time_step=1e-5", "--set", "end_time=2.3e-3"]
VOID = {"meta", "br", "img", "link", "input", "hr"}


class Page(html.parser.HTMLParser):
    """Tags that close in order, ids, what links and sources name, exact numbers, words."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.open, self.problems, self.ids, self.targets, self.values, self.words = [], [], [], [], [], ""
        self.images, self.tables, self.tags = [], 0, []
        self.feed(text)
        self.close()
        if self.open:
            self.problems.append(f"never closed: {self.open}")

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.tags.append(tag)
        if tag not in VOID:
            self.open.append(tag)
        if "id" in attributes:
            self.ids.append(attributes["id"])
        self.targets += [attributes[k] for k in ("href", "src", "xlink:href") if k in attributes]
        if attributes.get("data-value"):
            self.values.append(float(attributes["data-value"]))
        if tag == "img":
            self.images.append(attributes)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.problems.append(f"</{tag}> at {self.getpos()}")

    def handle_data(self, data):
        self.words += data


def png_pixels(path):
    """Rows of (r, g, b) of an 8-bit RGB file."""
    data = path.read_bytes()
    expect(data[:8] == b"\x89PNG\r\n\x1a\n", f"{path.name} is a PNG")
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        expect(zlib.crc32(kind + body) == struct.unpack(">I", data[at + 8 + length:at + 12 + length])[0], f"{kind} is whole") \
            if kind == b"IHDR" else None
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
        if kind == b"IDAT":
            packed += body
        at += 12 + length
    channels = {2: 3, 6: 4}[colour]
    raw, stride, rows_, previous = zlib.decompress(packed), width * channels, [], bytes(width * channels)
    for y in range(height):
        kind, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            a = line[x - channels] if x >= channels else 0
            b, c = previous[x], previous[x - channels] if x >= channels else 0
            p = a + b - c
            near = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            line[x] = (line[x] + (0, a, b, (a + b) // 2, near)[kind]) & 255
        rows_.append([tuple(line[x:x + 3]) for x in range(0, stride, channels)])
        previous = bytes(line)
    return width, height, rows_


def max_of_frame(path, field):
    """Largest value of a field of a frame; None without h5py."""
    try:
        import h5py
    except ImportError:
        return None
    with h5py.File(path) as frame:
        return float(frame["point"][field][()].max())


def pictures(place, run):
    result = strake("picture", run, "--at", "2e-3", "--size", "640x400", "--view=-0.3,-0.2,0.3,0.05", "-o", "p.png", cwd=place)
    expect(result.returncode == 0 and "0.002 s" in result.stdout, f"picture: exit {result.returncode}\n{result.stderr}")
    width, height, pixels = png_pixels(place / "p.png")
    expect((width, height) == (640, 400), f"a picture of the size asked for: {width}x{height}")
    colours = {c for row in pixels for c in row}
    expect(pixels[0][0] == (255, 255, 255) and len(colours) > 100, f"white around {len(colours)} colours")
    # --range: pressures far below a wide range are all the colour of its lower end.
    strake("picture", run, "--at", "2e-3", "--size", "640x400", "--view=-0.3,-0.2,0.3,-0.1", "--range", "1e8,2e8", "-o", "low.png",
           cwd=place)
    greenish = [sum(g > b for row in image[70:300] for r, g, b in row[70:620]) for image in (png_pixels(place / "low.png")[2], pixels)]
    expect(greenish[0] == 0 and greenish[1] > 1000, f"--range fixes the colours: above the middle {greenish[0]}, else {greenish[1]}")
    result = strake("picture", run, "--field", "speed", "--scale", "5", "-o", "p.svg", cwd=place)
    drawn = xml.etree.ElementTree.parse(place / "p.svg").getroot() if result.returncode == 0 else None
    expect(drawn is not None and drawn.tag.endswith("svg"), f"a picture as SVG is XML\n{result.stderr}")
    result = strake("picture", run, "--field", "von_mises", "-o", "s.png", cwd=place)
    said = re.search(r"von_mises of the structure: \S+ to (\S+) (\S*)Pa", result.stdout)
    last = sorted((run / "frames").glob("structure-*.h5"))[-1]
    most = max_of_frame(last, "von_mises")
    factor = {"": 1, "k": 1e3, "M": 1e6}[said.group(2)] if said else 1
    expect(said and (most is None or abs(float(said.group(1)) * factor / most - 1) < 1e-3),
           f"picture says the largest stress of the points: {result.stdout} {most}")
    expect("half a spacing inside a face" in result.stdout, "and that particles do not stand at the face")
    for wrong, code, word in ((["--field", "warmth"], 2, "pressure"), (["--size", "3"], 2, "1280x720"), (["-o", "x.gif"], 2, ".png"),
                              (["--view", "1,1,0,0"], 2, "corner"), (["--range", "5"], 2, "0,1e6"),
                              (["--at", "nan"], 2, "expected a number, not nan"), (["--scale", "inf"], 2, "expected a number")):
        result = strake("picture", run, *wrong, cwd=place)
        expect(result.returncode == code and word in result.stderr, f"{wrong} is refused: {result.stderr.strip()}")
    films(place, run)
    nothing = strake("picture", place, cwd=place)
    expect(nothing.returncode == 3 and "no frame" in nothing.stderr, f"picture of no run is refused: {nothing.returncode}")


def films(place, run):
    """ffmpeg gets its options and every frame; without it the error names the package."""
    none = dict(ENV, PATH=str(place))
    words = [str(BIN / "strake"), "film", str(run), "--from", "1.5e-3", "--size", "400x300", "-o", "f.mp4"]
    result = subprocess.run(words, cwd=place, env=none, capture_output=True, text=True, timeout=60)
    expect(result.returncode == 2 and "apt-get install ffmpeg" in result.stderr, f"no ffmpeg: {result.stderr.strip()}")
    tool = place / "tools" / "ffmpeg"
    tool.parent.mkdir()
    tool.write_text("#!/bin/sh\nfor out; do :; done\ncat > \"$out\"\n")
    tool.chmod(0o755)
    with_tool = dict(ENV, PATH=f"{tool.parent}:{os.environ['PATH']}")
    result = subprocess.run(words, cwd=place, env=with_tool, capture_output=True, text=True, timeout=60)
    frames = (place / "f.mp4").read_bytes().count(b"IEND") if result.returncode == 0 else 0
    expect(frames == 9 and "9 frames" in result.stdout, f"film: {frames} frames from 1.5 ms {result.stdout} {result.stderr}")
    tool.write_text("#!/bin/sh\necho no room >&2\nexit 1\n")
    (place / "f.mp4").unlink()
    result = subprocess.run(words, cwd=place, env=with_tool, capture_output=True, text=True, timeout=60)
    expect(result.returncode == 6 and "no room" in result.stderr, f"an ffmpeg that fails: {result.returncode} {result.stderr.strip()}")
    expect(not list(place.glob("f.mp4*")), "and nothing is left of it")


def read_page(path):
    text = path.read_text(encoding="utf-8")
    page = Page(text)
    expect(not page.problems, f"{path.name} is well formed {page.problems[:3]}")
    expect(len(page.ids) == len(set(page.ids)), f"{path.name}: every id is one of its own")
    inner = {t[1:] for t in page.targets if t.startswith("#")}
    expect(inner <= set(page.ids), f"{path.name}: every link within the page leads somewhere {inner - set(page.ids)}")
    fetched = [t for t in page.targets if not t.startswith(("#", "data:image/png;base64,"))]
    expect(not fetched and not re.search(r"https?:|url\(|@import|<script", text), f"{path.name} fetches nothing {fetched}")
    expect(all(i.get("alt") for i in page.images), f"{path.name}: every picture has words")
    return page


def has(page, value):
    return any(math.isclose(value, v, rel_tol=1e-12, abs_tol=0) for v in page.values)


def report_of_runs(place, runs):
    result = strake("report", *runs, "-o", "report.html", cwd=place)
    expect(result.returncode == 0 and "report.html" in result.stdout, f"report: exit {result.returncode}\n{result.stderr}")
    page = read_page(place / "report.html")
    for run in runs:
        summary = json.loads((run / "summary.json").read_text())
        expect(run.name in page.words, f"{run.name} is named")
        of_loads = ("impulse", "mean_peak_50us")  # of a deflection they mean nothing
        wanted = [v for probe in summary["probes"].values() for k, v in probe.items()
                  if k != "unit" and v is not None and (k not in of_loads or probe["unit"] in ("Pa", "N", "N/m"))]
        wanted += [v for v in summary["checks"].values() if isinstance(v, (int, float))] + [summary["end_time"], summary["seconds"]["wall"]]
        wanted += [x for c in summary["compare"] for x in (c["value"], c["reference"]) if x is not None]
        missing = [v for v in wanted if not has(page, v)]
        expect(not missing, f"{run.name}: {len(wanted)} numbers of summary.json stand on the page {missing[:3]}")
        for verdict in summary["compare"]:
            expect(verdict["source"] in page.words and verdict["kind"] in page.words, f"reference with source: {verdict['metric']}")
            if verdict["value"] is None:
                expect("not reached" in page.words or "outside" in page.words, f"{verdict['metric']} is not reached, and said so")
                continue
            expect(f"± {100 * verdict['tolerance']:.3g} %" in page.words, f"the tolerance of {verdict['metric']} stands there")
            off = (verdict["value"] - verdict["reference"]) / abs(verdict["reference"])
            expect(has(page, off), f"deviation {100 * off:.2f} % of {verdict['metric']}")
    for word in ("flat-bottom slamming", "structure.velocity", "time [ms]", "p_mid", "first peak", "--tag", "momentum_gap", "400 mm",
                 "impulse of the first 300 µs after contact"):
        expect(word in page.words, f"the page says {word!r}")
    record = json.loads((runs[0] / "run.json").read_text())
    for word in (record["host"], record["compiler"], "Limits", "no air", "one spacing"):
        expect(word in page.words, f"the page says {word!r}")
    expect("aerated" not in re.sub(r"strake run \S+.*", "", page.words), "notes of another variant are left out")
    table = (place / "report.html").read_text().partition("deflection mid.y")[2].partition("</table>")[0]
    expect("peak" in table and "impulse" not in table, "there is no impulse of a deflection")
    expect(page.tags.count("svg") > 4 and len(page.images) >= 2 * len(runs), f"{len(page.images)} pictures, plots")
    one = strake("report", runs[0], "--at", "1e-3,2e-3", cwd=place)
    page = read_page(runs[0] / "report.html")
    expect(one.returncode == 0 and len(page.images) == 2 and "t = 2 ms" in page.images[1]["alt"],
           f"--at chooses the pictures: {[i['alt'] for i in page.images]}")
    wrong = strake("report", runs[0], "--at", "1e-3,nan", cwd=place)
    expect(wrong.returncode == 2 and "expected a number, not nan" in wrong.stderr, f"--at nan is refused: {wrong.stderr.strip()}")


def names_are_escaped(place, run):
    evil = place / "runs" / "a<b>&\"c'"
    shutil.copytree(run, evil)
    text = (evil / "case.toml").read_text().replace('title = "flat-plate entry"', 'title = "<script>alert(1)</script> & co"')
    (evil / "case.toml").write_text(text)
    result = strake("report", evil, "-o", "evil.html", cwd=place)
    expect(result.returncode == 0, f"report of a strange name: {result.stderr}")
    page = read_page(place / "evil.html")
    expect("<script>alert(1)</script> & co" in page.words and evil.name in page.words, "names and titles are text, never tags")


def damaged_runs(place, run):
    for name, harm in {
            "unfinished": lambda f: (f / "summary.json").unlink(),
            "torn": lambda f: (f / "summary.json").write_text('{"probes": {"p_mid": 3, "x": '),
            "odd": lambda f: (f / "summary.json").write_text('{"probes": {"p_mid": 3}, "compare": [1, {}], "checks": 7}'),
            "no history": lambda f: (f / "history.csv").unlink(),
            "no frames": lambda f: shutil.rmtree(f / "frames"),
            "broken frames": lambda f: [p.write_bytes(b"no") for p in (f / "frames").iterdir()],
            "no record": lambda f: (f / "run.json").unlink(),
            "no case": lambda f: (f / "case.toml").unlink()}.items():
        copy = place / "runs" / name
        shutil.copytree(run, copy)
        harm(copy)
        result = strake("report", copy, "-o", "damaged.html", cwd=place)
        expect(result.returncode == 0, f"{name}: a report all the same\n{result.stderr}")
        page = read_page(place / "damaged.html")
        said = name in ("odd", "no frames", "broken frames") or "Not all of this is whole" in page.words
        expect(said, f"{name}: the page says what is missing")
    nothing = strake("report", place, cwd=place)
    expect(nothing.returncode == 3 and "run.json" in nothing.stderr, f"report of no run is refused: {nothing.returncode}")


def failure_is_told(place, run):
    copy = place / "runs" / "failed plate"
    shutil.copytree(run, copy)
    summary = json.loads((copy / "summary.json").read_text())
    summary["failure"] = {"start": {"time": 1.95e-3, "x": -0.2, "y": 0.0321, "z": 0}, "crack": None, "parted": None, "energy": 12.75}
    (copy / "summary.json").write_text(json.dumps(summary))
    strake("report", copy, "-o", "failure.html", cwd=place)
    page = read_page(place / "failure.html")
    expect(all(has(page, v) for v in (1.95e-3, -0.2, 0.0321, 12.75)) and "strength reached" in page.words,
           "where and when a structure fails, and what that released")


def report_of_study(place, runs):
    study = {"title": "two solvers", "study": "study_plate", "file": "cases/study_plate.toml", "case": "plate_entry.toml",
             "commands": ["strake study cases/study_plate.toml"],
             "axes": [{"name": "speed", "labels": ["6.26 m/s"]}, {"name": "solver", "labels": ["rigid", "particle", "fem"]}],
             "runs": [{"name": f"v6-{label}", "labels": {"speed": "6.26 m/s", "solver": label}, "folder": f"runs/{run.name}",
                       "state": "done", "exit_code": 0, "seconds": 12.5, "values": {"p_mid:first_peak": 1.5e6 + k}}
                      for k, (label, run) in enumerate(zip(("rigid", "particle"), runs))] +
                     [{"name": "v6-fem", "labels": {"speed": "6.26 m/s", "solver": "fem"}, "folder": "runs/none", "state": "missing",
                       "exit_code": None, "seconds": None, "values": {}}],
             "columns": [{"probe": "p_mid", "metric": "first_peak", "unit": "Pa"}],
             "checks": [{"title": "particle and rigid", "run": "v6-particle", "against": "v6-rigid", "probe": "p_mid",
                         "metric": "first_peak", "value": 1500001.0, "reference": 1500000.0, "deviation": 6.66e-7, "tolerance": None,
                         "pass": True, "kind": "code", "source": ""}],
             "convergence": [{"title": "deflection with spacing", "axis": "l0", "probe": "mid.y", "metric": "first_peak", "unit": "m",
                              "along": [0.02, 0.01, 0.005], "values": [1.9e-3, 1.7e-3, 1.625e-3], "order": 1.42, "extrapolated": 1.58e-3,
                              "gci": 0.035, "remark": "converges"}],
             "claims": [{"claim": "peak pressure grows with speed", "source": "Tab. 1", "measured": "as V^1.7", "verdict": "holds",
                         "why": "four speeds"}],
             "seconds": 1234.5}
    (place / "study.json").write_text(json.dumps(study))
    result = strake("report", place, "-o", "study.html", cwd=place)
    expect(result.returncode == 0, f"report of a study: exit {result.returncode}\n{result.stderr}")
    page = read_page(place / "study.html")
    for word in ("v6-rigid", "v6-particle", "v6-fem", "missing", "peak pressure grows with speed", "holds", "deflection with spacing",
                 "strake study cases/study_plate.toml", "speed 6.26 m/s", "3.50 %"):
        expect(word in page.words, f"the study's page says {word!r}")
    for value in (1.5e6, 1500001.0, 6.66e-7, 1.42, 1.58e-3, 0.035):
        expect(has(page, value), f"the study's page holds {value}")
    (place / "study.json").write_text("[1, 2")
    expect(strake("report", place, cwd=place).returncode == 3, "a torn study.json is refused")
    (place / "study.json").write_text('{"axes": [3, {"labels": [1]}], "runs": [{"name": "x", "values": []}], "checks": [{}], "claims": 0}')
    odd = strake("report", place, "-o", "odd.html", cwd=place)
    expect(odd.returncode == 0, f"a study.json with holes still gives a page\n{odd.stderr}")
    read_page(place / "odd.html")
    (place / "study.json").unlink()


with folder() as place:
    place = pathlib.Path(place)
    runs = []
    for solver in ("rigid", "particle"):
        result = strake("run", CASE, *QUICK, "--set", f"structure.solver={solver}", "--tag", solver, "--quiet", cwd=place, timeout=280)
        expect(result.returncode == 0, f"run {solver}: exit {result.returncode}\n{result.stderr}")
        runs.append(place / "runs" / f"plate_entry-{solver}")
    pictures(place, runs[1])
    report_of_runs(place, runs)
    names_are_escaped(place, runs[0])
    damaged_runs(place, runs[0])
    failure_is_told(place, runs[0])
    report_of_study(place, runs)
finish()
