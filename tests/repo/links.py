"""Every link of a page and every citation of a page in a source leads somewhere. Relative links exist, with their headings.
`cases/VALIDATION.md, "Sloshing"` and `(cases/VALIDATION.md, Sloshing)` name a heading, `fluid/THEORY.md (F12)` an equation.
The identifiers of a page's tables stand in the sources that their rows link to: `[file](file), \`function\`` as well."""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
rooms = ("proto", "fluid", "structure", "coupler", "cases", "tests")
page = r"((?:(?:proto|fluid|structure|coupler|cases|tests)/)?[A-Z_]+\.md)"
problems, checked = [], 0


def headings(path):
    text = re.sub(r"^```.*?^```", "", path.read_text(encoding="utf-8"), flags=re.M | re.S)
    return [re.sub(r"[`*]", "", line) for line in re.findall(r"^#+ +(.*?) *$", text, re.M)]


def anchors(path):
    return {"".join(c for c in h.lower() if c.isalnum() or c in " -_").replace(" ", "-") for h in headings(path)}


def check(condition, where, what):
    global checked
    checked += 1
    if not condition:
        problems.append(f"{where}: {what}")


def links(path, text):
    for target in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)):
        if target.startswith(("http://", "https://")):
            continue
        name, _, anchor = target.partition("#")
        to = path.parent / name if name else path
        check(to.exists(), path.relative_to(root), f"links to {target}, which does not exist")
        if anchor and to.suffix == ".md" and to.exists():
            check(anchor in anchors(to), path.relative_to(root), f"links to {target}: there is no such heading")


def citations(path, text):
    where = path.relative_to(root)
    text = re.sub(r"\s*\n\s*(?:///?|#|\*)?\s*", " ", text)  # comments are broken into lines
    for name, heading in [*re.findall(page + r', "([^"]+)"', text), *re.findall(r"\(" + page + r", ([A-Z][^()]+)\)", text)]:
        check((root / name).exists() and heading in headings(root / name), where, f"cites {name}, \"{heading}\": there is no such heading")
    for name, equation in re.findall(page + r" (\([FSC]\d+\))", text):
        check((root / name).exists() and equation in (root / name).read_text(encoding="utf-8"), where, f"cites {name} {equation}: there is no such equation")


def identifiers(path, text):
    where = path.relative_to(root)
    source = r"\]\(([^)#\s]+\.(?:cpp|hpp|py))\)"
    named = [([to], [name]) for to, name in re.findall(source + r",\s+`(\w+)`", text)]
    if path.name == "THEORY.md":  # symbol | identifiers | sources
        for row in re.findall(r"^\|[^|]+\|([^|]*`[^|]*)\|([^|]*\]\([^|]*)\|$", text, re.M):
            named.append((re.findall(source, row[1]), re.findall(r"`([\w:]+)`", row[0])))
    for files, names in named:
        texts = "".join((path.parent / file).read_text(encoding="utf-8") for file in files if (path.parent / file).exists())
        for name in names if texts else ():
            check(re.search(rf"\b{name.split('::')[-1]}\b", texts), where, f"{name} does not stand in {', '.join(files)}")


for path in sorted([*root.glob("*.md"), *(p for room in rooms for p in (root / room).rglob("*"))]):
    if "node_modules" in path.parts or path.resolve() == pathlib.Path(__file__).resolve():
        continue
    if path.suffix == ".md":
        links(path, path.read_text(encoding="utf-8"))
        identifiers(path, path.read_text(encoding="utf-8"))
    if path.suffix in (".md", ".toml", ".cpp", ".hpp", ".py"):
        citations(path, path.read_text(encoding="utf-8"))
print("\n".join(problems) or f"{checked} links, citations and identifiers lead somewhere")
sys.exit(bool(problems))
