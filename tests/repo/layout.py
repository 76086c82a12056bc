"""The top level is the one that the design fixes, and sources stay readable in one sitting."""
import pathlib
import sys

root = pathlib.Path(sys.argv[1])
allowed = {"CMakeLists.txt", "README.md", "CONTRIBUTING.md", "CHANGELOG.md", "CITATION.cff", "LICENSE", "fluid", "structure",
           "coupler", "proto", "cases", "tests"}
made = {"runs"}  # what the README's commands make; ignored by git
found = {p.name for p in root.iterdir() if not p.name.startswith(".")}
extra = {n for n in found - allowed - made if not n.startswith("build")}
problems = [f"at the top level but not in the design: {name}" for name in sorted(extra)]
problems += [f"missing at the top level: {name}" for name in sorted(allowed - found)]
for folder in ("fluid", "structure", "coupler", "proto"):
    for path in sorted((root / folder).rglob("*.[ch]pp")):
        lines = path.read_text(encoding="utf-8").count("\n")
        if lines > 400:
            problems.append(f"{path.relative_to(root)}: {lines} lines; one idea per file, at most 400")
        if path.suffix == ".hpp" and "#pragma once" not in path.read_text(encoding="utf-8"):
            problems.append(f"{path.relative_to(root)}: a header without #pragma once")
print("\n".join(problems) or "layout as designed")
sys.exit(bool(problems))
