"""No two types have one qualified name. A program that links both would mix their functions, without a word.

    tests/repo/type_names.py ROOT      exits 1 where two files define the same type in the same namespace

Types in unnamed namespaces, local types and types within types do not count.
"""
import collections
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
NO_CODE = re.compile(r'//.*|"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])\'')
NAMESPACE = re.compile(r"(?:inline )?namespace ?([\w:]*) \{")
TYPE = re.compile(r"(?:class|struct|enum class|enum) (\w+)(?: final)?(?: : [^;]*)? \{")


def types(text):
    """Qualified names of the types that a file defines in named namespaces."""
    scopes = []  # names of the open braces; None: no namespace
    for line in text.splitlines():
        code = NO_CODE.sub("", line).strip()
        named = NAMESPACE.match(code)
        defined = TYPE.match(code)
        if defined and all(scopes):
            yield "::".join(scopes + [defined.group(1)])
        for sign in code:
            if sign == "{":
                scopes.append((named.group(1) or None) if named else None)
                named = None
            elif sign == "}" and scopes:
                scopes.pop()


places = collections.defaultdict(list)
for part in ("proto", "fluid", "structure", "coupler"):
    for path in sorted((root / part).rglob("*.[ch]pp")):
        for name in types(path.read_text(encoding="utf-8")):
            places[name].append(str(path.relative_to(root)))
problems = [f"{name} is defined in {' and '.join(files)}: give one of them another name"
            for name, files in sorted(places.items()) if len(files) > 1]
print("\n".join(problems) or f"{len(places)} types, each with a name of its own")
sys.exit(bool(problems) or not places)
