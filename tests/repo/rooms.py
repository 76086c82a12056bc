"""Every folder of sources has a README.md with the parts that a room's page has. It names every source of the folder, and
under "May include" every folder whose headers these sources include. A function that it cites beside a file stands there.
No folder holds more than 25 sources, tests included."""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
ROOMS, SOURCES, MADE = ("proto", "fluid", "structure", "coupler"), {".cpp", ".hpp", ".ts", ".py"}, {"bundle", "node_modules", "corpus"}
PARTS = ("In", "Out", "May include", "Files in reading order", "To add")
MOST = 25

folders = {}  # folder: its sources
for path in sorted(p for part in (*ROOMS, "cases", "tests") for p in (root / part).rglob("*")):
    if path.suffix in SOURCES and not MADE & set(path.parts):
        folders.setdefault(path.parent, []).append(path)

problems, checked = [], 0
for folder, sources in folders.items():
    name = folder.relative_to(root).as_posix()
    if len(sources) > MOST:
        problems.append(f"{name}: {len(sources)} sources; at most {MOST}")
    if name.split("/")[0] not in ROOMS:
        continue
    page = folder / "README.md"
    text = re.sub(r"\n +", " ", page.read_text(encoding="utf-8")) if page.exists() else ""
    parts = dict(re.findall(r"^- ([A-Z][a-z ]+): (.+)$", text, re.M))
    where = f"{name}/README.md"
    main = name in ROOMS  # says what to add in a section of its own
    problems += [f"{where}: no line \"- {part}: …\"" for part in PARTS if part not in parts and not (main and part == "To add")]
    links = {pathlib.Path(target).stem for target in re.findall(r"\]\(([^)#]+)", parts.get("Files in reading order", ""))}
    problems += [f"{where}: \"Files in reading order\" does not name {stem}" for stem in sorted({s.stem for s in sources} - links)]
    listed = set(re.findall(r"[\w/]+", parts.get("May include", "")))
    includes = {header.rpartition("/")[0]: source.name for source in sources if source.suffix in {".cpp", ".hpp"}
                for header in re.findall(r'^\s*#include "([^"]+)"', source.read_text(encoding="utf-8"), re.M) if (root / header).exists()}
    problems += [f"{where}: \"May include\" lacks {other}, which {source} includes"
                 for other, source in includes.items() if other not in listed | {name}]
    problems += [f"{where}: \"May include\" names {other}, which holds no sources"
                 for other in sorted(listed) if other.startswith(ROOMS) and root / other not in folders]
    for target, function in re.findall(r"\]\(([^)#]+\.[ch]pp)\), `(\w+)`", text):
        checked += 1
        if function not in (folder / target).read_text(encoding="utf-8"):
            problems.append(f"{where}: {target} holds no `{function}`")
print("\n".join(problems) or f"{len(folders)} folders, {checked} cited functions as their pages say")
sys.exit(bool(problems))
