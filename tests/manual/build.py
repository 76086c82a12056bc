"""Binds all pages of the repository and the API reference of its headers into one HTML manual.

    tests/manual/build.py ROOT OUT [--no-reference]    OUT/manual-pages: what mkdocs reads; OUT/manual: the manual

Pages keep their places. A link to a source leads to the page that Doxygen makes of it, or to its text. No warning of mkdocs
or Doxygen is let through, and every link and anchor of a page leads somewhere.
"""
import html
import html.parser
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree

root, out = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
here = pathlib.Path(__file__).resolve().parent
pages, site = out / "manual-pages", out / "manual"
ROOMS = {"fluid": "The water", "structure": "The body", "coupler": "The coupling", "proto": "What all share"}


def refuse(why):
    """Ends the program; half a manual is none."""
    shutil.rmtree(site, ignore_errors=True)
    sys.exit(f"no manual: {why}")


def run(*words, **options):
    if code := subprocess.run(words, **options).returncode:
        refuse(f"{words[0]} exits {code}")


def all_pages():
    found = [*root.glob("*.md"), *(p for part in (*ROOMS, "cases", "tests") for p in (root / part).rglob("*.md"))]
    return sorted(p for p in found if "node_modules" not in p.parts)


def make_reference():
    """Runs Doxygen; returns header -> its page, both as paths from the root."""
    out.mkdir(exist_ok=True)
    front = out / "manual-front.dox"
    front.write_text('/** \\mainpage\nAll headers of Strake, folder by folder. The <a href="../index.html">manual</a> says what '
                     'the folders are for. */\n', encoding="utf-8")
    tags = out / "manual-tags.xml"
    inputs = " ".join(f'"{root / room}"' for room in ROOMS)
    settings = (here / "Doxyfile").read_text(encoding="utf-8") + f"""
PROJECT_NAME = Strake
INPUT = {inputs} "{front}"
STRIP_FROM_PATH = "{root}"
INCLUDE_PATH = "{root}"
INPUT_FILTER = "awk -f {here / 'comments.awk'}"
OUTPUT_DIRECTORY = "{pages}"
HTML_OUTPUT = reference
GENERATE_TAGFILE = "{tags}"
"""
    run("doxygen", "-", input=settings, text=True)
    made = {}
    for compound in xml.etree.ElementTree.parse(tags).getroot().iter("compound"):
        if compound.get("kind") == "file":
            name = pathlib.Path(compound.findtext("path", ""), compound.findtext("name", ""))
            made[str(name.relative_to(root) if name.is_absolute() else name)] = "reference/" + compound.findtext("filename", "")
    return made


def text_page(source):
    """The text of a source that Doxygen has no page of, as a page without style."""
    name = source.relative_to(root).as_posix()
    page = pages / "sources" / f"{name}.html"
    page.parent.mkdir(parents=True, exist_ok=True)
    page.write_text(f"<!doctype html><meta charset='utf-8'><title>{name}</title><h1>{name}</h1>"
                    f"<pre>{html.escape(source.read_text(encoding='utf-8'))}</pre>\n", encoding="utf-8")
    return page.relative_to(pages).as_posix()


def copy_page(source, reference):
    """A page at its place, with links that work in the manual and the blank lines that mkdocs wants before lists."""
    place = pages / source.relative_to(root)
    place.parent.mkdir(parents=True, exist_ok=True)

    def link(match):
        text, target = match.groups()
        name, _, anchor = target.partition("#")
        to = (source.parent / name).resolve()
        if target.startswith(("http://", "https://", "#")) or to.suffix == ".md":
            return match.group(0)
        if to.suffix in (".png", ".svg", ".gif"):
            copy = pages / to.relative_to(root)
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(to, copy)
            return match.group(0)
        if not to.is_file():
            return text
        made = reference.get(to.relative_to(root).as_posix()) or text_page(to)
        return f"[{text}]({os.path.relpath(pages / made, place.parent)})"

    written, fenced, before = [], False, ""
    for line in source.read_text(encoding="utf-8").splitlines():
        fence = line.lstrip().startswith("```")
        if not fenced and not fence:
            item = re.match(r"(- |\d+\. |\|)", line)
            if item and before and not re.match(r"(- |\d+\. |\||  )", before):
                written.append("")
            line = re.sub(r"\[([^\]]*)\]\(([^)\s]+)\)", link, line)
        fenced ^= fence
        before = line
        written.append(line)
    place.write_text("\n".join(written) + "\n", encoding="utf-8")


def title(page):
    return page.read_text(encoding="utf-8").partition("\n")[0].lstrip("# ")


def navigation(found):
    """By what a reader is after, then room by room in the order of the room's own page."""
    def entry(name, label=None):
        return {label or title(root / name): name}

    use = {"cases/TUTORIAL.md": "Tutorial", "cases/README.md": "Cases", "cases/VALIDATION.md": "Validation",
           "proto/CASE_FILE.md": "Case file", "proto/STUDY_FILE.md": "Study file", "proto/RESULTS.md": "Results of a run",
           "proto/WIRE.md": "Messages"}
    rooms = []
    for room, label in ROOMS.items():
        page = f"{room}/README.md"
        inside = [p.relative_to(root).as_posix() for p in found if p.is_relative_to(root / room)]
        inside = [name for name in inside if name not in use and name != page]
        order = re.findall(r"\]\(([\w/]+/README\.md)\)", (root / page).read_text(encoding="utf-8"))
        inside.sort(key=lambda name: order.index(name[len(room) + 1:]) if name[len(room) + 1:] in order else -1)
        rooms.append({f"{label}: {room}/": [entry(page, "Overview")] + [
            entry(name, name.removesuffix("/README.md") if name.endswith("/README.md") else None) for name in inside]})
    return [entry("README.md", "Strake"), {"Use": [entry(*pair) for pair in use.items()]}, *rooms,
            {"Change": [entry("CONTRIBUTING.md", "Contributing"), entry("tests/README.md", "Tests"), entry("CHANGELOG.md", "Changelog"),
                        {"API reference": "api.md"}]}]


class Links(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.targets, self.ids = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for key, value in attributes:
            if key == "id":
                self.ids.add(value)
            if key in ("href", "src") and value:
                self.targets.append(value)


def broken_links():
    built = {p: Links(p.read_text(encoding="utf-8")) for p in site.rglob("*.html")
             if not {"reference", "sources"} & set(p.relative_to(site).parts[:1])}
    for page, links in built.items():
        for target in links.targets:
            name, _, anchor = target.partition("#")
            to = (page.parent / name).resolve() if name else page
            where = f"{page.relative_to(site)}: {target}"
            if target.startswith(("http:", "https:")):
                continue
            if not to.exists():
                yield f"{where}: no such file"
            elif anchor and to in built and anchor not in built[to].ids:
                yield f"{where}: no such anchor"


def main():
    for folder in (pages, site):
        shutil.rmtree(folder, ignore_errors=True)
    pages.mkdir(parents=True)
    reference = make_reference()
    found = all_pages()
    for page in found:
        copy_page(page, reference)
    (pages / "api.md").write_text("# API reference\n\n[All headers](reference/files.html), [classes](reference/annotated.html), "
                                  "[functions and types of namespaces](reference/namespacemembers.html), made from the sources by Doxygen.\n",
                                  encoding="utf-8")
    settings = out / "manual.yml"
    settings.write_text(f"""site_name: Strake
docs_dir: {json.dumps(str(pages))}
site_dir: {json.dumps(str(site))}
use_directory_urls: false
theme:
  name: null
  custom_dir: {json.dumps(str(here / 'theme'))}
plugins: []
markdown_extensions:
  - toc:
      slugify: !!python/name:slug.github
      toc_depth: 3
nav: {json.dumps(navigation(found), ensure_ascii=False)}
""", encoding="utf-8")
    run(sys.executable, "-m", "mkdocs", "build", "--strict", "--config-file", str(settings),
        env={**os.environ, "PYTHONPATH": str(here), "PYTHONDONTWRITEBYTECODE": "1"})
    if problems := list(broken_links()):
        refuse("\n".join(problems))
    print(f"the manual of {len(found)} pages and {len(reference)} headers: {site / 'index.html'}")


if __name__ == "__main__":
    main()
