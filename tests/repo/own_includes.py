"""Each source compiles alone: it reaches, by its own #include lines, a declaration of every type of ours that it names.

    tests/repo/own_includes.py ROOT     exits 1 where a type is named that the file's includes do not declare

The sources of one folder compile as one (CMakeLists.txt, strake_library), which hides a header that is missing: another source has
included it before. It shows first in builds that compile each source alone, those of the sanitizers and of STRAKE_UNITY=OFF."""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
PARTS = ("proto", "fluid", "structure", "coupler")  # strake_library is theirs
COMMENT_OR_TEXT = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', re.DOTALL)
INCLUDE = re.compile(r'^\s*#include\s+"([^"]+)"', re.MULTILINE)
DECLARED = re.compile(r"\b(?:struct|class|enum|using|typename|concept)(?:\s*\.\.\.)?\s+(?:\[\[.*?\]\]\s*)?([A-Z]\w*)")
AT_NAMESPACE = re.compile(r"^(?:struct|class|enum class|enum|using|concept)\s+(?:\[\[.*?\]\]\s*)?([A-Z]\w*)", re.MULTILINE)
NAMED = re.compile(r"(?<![\w:.>])(?:strake::(?:fluid::|structure::)?)?([A-Z]\w*)")

text, includes = {}, {}
for part in PARTS:
    for path in sorted((root / part).rglob("*.[ch]pp")):
        name, whole = path.relative_to(root).as_posix(), path.read_text(encoding="utf-8")
        beside = path.parent.relative_to(root).as_posix()
        includes[name] = [other if (root / other).exists() else f"{beside}/{other}" for other in INCLUDE.findall(whole)]
        text[name] = COMMENT_OR_TEXT.sub(" ", whole)
declared = {name: set(DECLARED.findall(code)) for name, code in text.items()}
# Types of headers at the level of a namespace; a type within a class is named where the class is known.
ours = {}
for name, code in text.items():
    if name.endswith(".hpp"):
        for found in AT_NAMESPACE.findall(code):
            ours.setdefault(found, []).append(name)


def reached(name):
    seen, stack = {name}, [name]
    while stack:
        for other in includes.get(stack.pop(), ()):
            if other not in seen:
                seen.add(other)
                stack.append(other)
    return seen


problems = []
for name, code in text.items():
    if name.startswith("coupler/precice/"):
        continue  # preCICE's own names and headers, which lie on a path of their own
    known = set().union(*(declared.get(other, set()) for other in reached(name)))
    for missing in sorted({found for found in NAMED.findall(code) if found in ours} - known):
        line = next(n for n, row in enumerate(code.splitlines(), 1) if re.search(rf"\b{missing}\b", row))
        problems.append(f"{name}: names {missing} (near line {line}), which {ours[missing][0]} declares; it does not include that")
print("\n".join(problems) or f"each of {len(text)} sources includes what declares the types that it names")
sys.exit(bool(problems))
