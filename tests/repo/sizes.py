"""Functions of at most 60 lines, classes of at most 20 data members.

    tests/repo/sizes.py ROOT [--list]      exits 1 where there are more; --list: prints all over half of that
"""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
LINES, MEMBERS = 60, 20
# Each with its reason; at most five functions and three classes.
LONGER_FUNCTIONS = {
    ("structure/particle/stepping.cpp", "ParticleSolver<dim>::sub_step"):
        "one leapfrog step; its kicks, move and work account share nearly every quantity",
    ("structure/body/solid_surface.cpp", "sphere_surface"): "one construction, from icosahedron to sphere",
}
LARGER_CLASSES = {}

NO_FUNCTION = re.compile(r"\s*(namespace|class|struct|enum|union|if|for|while|switch|do|else|return|case|public|private|protected|"
                         r"template|using|static_assert|\}|#|//)\b|\s*[}#/]")
MEMBER = re.compile(r"\b(\w+_)\s*(?:\{[^;]*\}|=[^;]*|\[[^;]*\])?\s*(?=[,;])")


def functions(lines):
    """Name, first line and length of each function, from the layout that clang-format gives."""
    for first, line in enumerate(lines):
        indent = re.match(r" *", line).group()
        if not line.strip() or len(indent) > 2 or NO_FUNCTION.match(line):
            continue
        last = first
        while last < min(first + 8, len(lines) - 1) and not lines[last].rstrip().endswith(("{", ";", "}", ":")):
            last += 1
        head = " ".join(lines[first:last + 1])
        if not lines[last].rstrip().endswith("{") or "(" not in head or re.search(r"=\s*\{$|= \[.*\]|\{.*\{$|->add_", head):
            continue
        end = last + 1
        while end < len(lines) and not re.match(indent + r"\}", lines[end]):
            end += 1
        name = re.search(r"([\w:~<>]+)\(", head)
        yield (name.group(1) if name else head.strip()[:40]), first + 1, end - first + 1


def classes(text):
    """Name, first line and data members, whose names end in '_', of each class."""
    for found in re.finditer(r"^( *)class (\w+)[^;{]*\{$(.*?)^\1\};", text, re.M | re.S):
        body = re.sub(r"//.*", "", found.group(3))
        inner = found.group(1) + "  "
        members = set()
        for statement in re.findall(rf"^{inner}(?! )([^(){{}}]*?(?:\{{[^;]*\}})?;)", body, re.M | re.S):
            members.update(MEMBER.findall(statement))
        yield found.group(2), text.count("\n", 0, found.start()) + 1, len(members)


problems, listed, seen = [], [], set()
for part in ("proto", "fluid", "structure", "coupler"):
    for path in sorted((root / part).rglob("*.[ch]pp")):
        text = path.read_text(encoding="utf-8")
        place = path.relative_to(root).as_posix()
        for what, found, limit, allowed in (("function", functions(text.splitlines()), LINES, LONGER_FUNCTIONS),
                                            ("class", classes(text), MEMBERS, LARGER_CLASSES)):
            unit = "lines" if what == "function" else "data members"
            for name, line, size in found:
                row = f"{place}:{line}: {what} {name}: {size} {unit}"
                if size > limit / 2:
                    listed.append((size / limit, row))
                if size > limit and (place, name) in allowed:
                    seen.add((place, name))
                elif size > limit:
                    problems.append(f"{row}, at most {limit}")
for place, name in (LONGER_FUNCTIONS.keys() | LARGER_CLASSES.keys()) - seen:
    problems.append(f"{place}: {name} is listed as an exception and is none")
if len(LONGER_FUNCTIONS) > 5 or len(LARGER_CLASSES) > 3:
    problems.append("more than five functions or three classes are excepted")
if "--list" in sys.argv:
    print("\n".join(row for _, row in sorted(listed, reverse=True)))
print("\n".join(problems) or "functions and classes of readable size")
sys.exit(bool(problems))
