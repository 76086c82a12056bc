"""The direction of dependencies, checked on the graph of all #include lines, not on direct ones alone.

    tests/repo/include_rules.py ROOT [--rooms]     exits 1 where a rule is broken, with the chain of includes
                                                   --rooms: prints the folders, lowest first, and what each includes
"""
import collections
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
PARTS = ("proto", "fluid", "structure", "coupler")
CASE_FILE = "proto/case/case_file.hpp"
# Library headers and the only places that may include them.
LIBRARIES = {
    "zmq": ("coupler/transport/",),
    "deal.II/": ("structure/fem/",),
    "toml++": ("proto/case/", "coupler/case/"),
    "google/protobuf": ("proto/wire/",),
    "hdf5": ("proto/files/",),
    "cairo": ("coupler/plot/",),
    "httplib": ("coupler/watch/",),
    "expat": ("coupler/precice/config/",),
    "zip.h": ("coupler/attachments/fmu/",),
    "zoltan": ("fluid/ranks/",),
}
# Headers that the numerical method never reaches: files, messages, other processes.
NOT_IN_A_CORE = ("coupler/", CASE_FILE, "proto/files/result_file", "proto/files/history", "proto/wire/", "proto/coupling")
# Folders of fluid/ and structure/ that belong to the programs and not to the method.
PROGRAM_FOLDERS = {"fluid", "fluid/case", "fluid/replay", "structure", "structure/case", "structure/replay", "structure/ccx",
                   "structure/deck_export"}
PROGRAM_FILE = re.compile(r"(^|[_/])program\.cpp$")  # defines this_program()

sources = {}  # path: [(line, header)]
for part in PARTS:
    for path in sorted((root / part).rglob("*.[ch]pp")):
        lines = path.read_text(encoding="utf-8").splitlines()
        found = ((n, re.match(r'\s*#include\s+[<"]([^>"]+)[>"]', line)) for n, line in enumerate(lines, 1))
        sources[path.relative_to(root).as_posix()] = [(n, match.group(1)) for n, match in found if match]


def folder_of(name):
    return name.rsplit("/", 1)[0]


def reached(name):
    """Every header that a file includes, itself or through others: header -> who includes it."""
    via, stack = {name: None}, [name]
    while stack:
        here = stack.pop()
        for _, header in sources.get(here, ()):
            if header not in via:
                via[header] = here
                stack.append(header)
    return via


def chain(via, header):
    names = [header]
    while via[names[-1]]:
        names.append(via[names[-1]])
    return " <- ".join(names)


def is_case_folder(name):
    return "case" in name.split("/")[:-1]


def is_core(name):
    return (name.startswith(("fluid/", "structure/")) and folder_of(name) not in PROGRAM_FOLDERS
            and not PROGRAM_FILE.search(name))


problems = []
arrows = collections.defaultdict(set)  # folder: folders that it includes
example = {}
for name, includes in sources.items():
    part = name.split("/")[0]
    for number, header in includes:
        where = f"{name}:{number}: includes {header}"
        if header in sources and folder_of(header) != folder_of(name):
            arrows[folder_of(name)].add(folder_of(header))
            example.setdefault((folder_of(name), folder_of(header)), f"{name}:{number}")
        for library, places in LIBRARIES.items():
            if header.startswith(library) and not name.startswith(places):
                problems.append(f"{where}; only {', '.join(places)} includes this library")
    via = reached(name)
    for header in via:
        other = header.split("/")[0]
        through = f"{name}: reaches {chain(via, header)}"
        if other not in PARTS or header not in sources:
            continue
        if part == "proto" and other != "proto":
            problems.append(f"{through}; proto depends on nothing else of Strake")
        if {part, other} == {"fluid", "structure"}:
            problems.append(f"{through}; fluid and structure never know one another")
        if part == "coupler" and other in ("fluid", "structure"):
            problems.append(f"{through}; the coupler knows no solver")
        if part in ("fluid", "structure") and other == "coupler" and folder_of(header) != "coupler/participant":
            problems.append(f"{through}; solvers include of the coupler coupler/participant alone")
        if part != "proto" and header == CASE_FILE and not is_case_folder(name):
            problems.append(f"{through}; only folders named case see the case file")
        if is_core(name) and header.startswith(NOT_IN_A_CORE):
            problems.append(f"{through}; the method knows Eigen and proto's values alone")

# Folders in an order in which each includes only earlier ones; what is left over includes in a circle.
order, left = [], {folder_of(name) for name in sources}
while left:
    free = sorted(folder for folder in left if not (arrows[folder] & left))
    if not free:
        circle = sorted(folder for folder in left if any(folder in arrows[other] for other in left))
        links = sorted(f"{a} -> {b} ({example[a, b]})" for a in circle for b in arrows[a] & set(circle))
        problems.append("folders that include one another in a circle:\n  " + "\n  ".join(links))
        break
    order += free
    left -= set(free)

if "--rooms" in sys.argv:
    for folder in order:
        print(f"{folder}: {', '.join(sorted(arrows[folder], key=order.index)) or '-'}")
print("\n".join(problems) or f"includes as designed: {len(sources)} files, {len(order)} folders in one order")
sys.exit(bool(problems))
