"""The direction of dependencies, as it shows in the #include lines: fluid and structure never meet, the cores read
no sockets, messages, files or case tables, and the transport library is named by the link and its parts."""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
outside_core = {  # parts of fluid/ and structure/ that belong to the programs, not to the cores
    "participant.cpp", "participant.hpp", "main.cpp", "parameters.cpp", "parameters.hpp", "replay.cpp", "replay.hpp",
    "replay_main.cpp",
}
transport = {"coupler/link.cpp", "coupler/zmq_parts.hpp", "coupler/doorkeeper.cpp", "coupler/doorkeeper.hpp"}
problems = []


def includes(path):
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        found = re.match(r'\s*#include\s+[<"]([^>"]+)[>"]', line)
        if found:
            yield number, found.group(1)


for path in sorted(root.glob("*/**/*.[ch]pp")):
    part = path.relative_to(root).parts[0]
    if part not in ("proto", "fluid", "structure", "coupler"):
        continue
    for number, name in includes(path):
        where = f"{path.relative_to(root)}:{number}: includes {name}"
        if part == "fluid" and name.startswith("structure/") or part == "structure" and name.startswith("fluid/"):
            problems.append(f"{where}; fluid and structure never know one another")
        if part == "proto" and name.startswith(("fluid/", "structure/", "coupler/")):
            problems.append(f"{where}; proto depends on nothing of ours")
        if name.startswith("zmq") and path.relative_to(root).as_posix() not in transport:
            problems.append(f"{where}; only coupler/link.cpp, its parts and its doorkeeper speak ZeroMQ")
        # A program of its own that starts another one.
        core = part in ("fluid", "structure") and path.name not in outside_core and path.parent.name != "ccx"
        if core and name.startswith(("coupler/", "proto/result_file", "proto/case_file", "proto/wire", "proto/coupling",
                                     "proto/history", "hdf5", "toml++", "google/protobuf", "thread")):
            problems.append(f"{where}; a core knows Eigen and proto's values alone")
        if name.startswith("deal.II/") and "structure/fem/" not in path.as_posix():
            problems.append(f"{where}; deal.II stays inside structure/fem")
print("\n".join(problems) or "includes as designed")
sys.exit(bool(problems))
