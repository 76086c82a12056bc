"""No sentence of a comment has more than 40 words.

A sentence ends with a full stop, a blank comment line, a list line, an indented line or an equation on a line of its own.
`--first` also lists the comments whose first sentence has more than 20 words; that is advice, not a failure.
"""
import pathlib
import re
import sys

LIMIT, FIRST = 40, 20
root, advise = pathlib.Path(sys.argv[1]), "--first" in sys.argv
quoted = r"""(?:"(?:\\.|[^"\\\n])*"|(?<!\w)'(?:\\.|[^'\\\n])*')"""
slashes = re.compile(r'R"(\w*)\((?s:.*?)\)\1"|' + quoted + r"|(?P<line>//[^\n]*)|(?P<block>/\*(?s:.*?)\*/)")
hashes = re.compile(r'(?P<block>(?m:^) *"""(?s:.*?)""")|"""(?s:.*?)"""|' + "'''(?s:.*?)'''|" + quoted + r"|(?P<line>\#[^\n]*)")
abbreviation = re.compile(r"(?:\b(?:e\.g|i\.e|cf|al|vol|no|pp?|vs|eq|Eq|Fig|Sec|ch|approx|resp))\.$")


def comments(text, grammar):
    """Lists of (line number, text) that belong together; the text keeps its indentation behind the comment's mark."""
    group, last = [], (0, 0)
    for found in grammar.finditer(text):
        if not (found["line"] or found["block"]):
            continue
        number, begin = text.count("\n", 0, found.start()) + 1, text.rfind("\n", 0, found.start()) + 1
        alone = not text[begin:found.start()].strip()
        if group and not (found["line"] and alone and last == (number - 1, found.start() - begin)):
            yield group
            group = []
        if found["line"]:
            group.append((number, re.sub(r"^(?://[/!]?<?|#+!?)", "", found["line"])))
        else:
            inside = re.sub(r'^ *(?:/\*+|""")|(?:\*+/|""")$', "", found[0])
            lines = [re.sub(r"^\s*\*(?!\*)", " ", line) for line in inside.split("\n")]
            indent = min((len(t) - len(t.lstrip()) for t in lines[1:] if t.strip()), default=0)
            group = [(number + k, t if k else " " * indent + t.strip()) for k, t in enumerate(lines)]
        last = (number, found.start() - begin) if found["line"] else (0, 0)
    if group:
        yield group


def items(group):
    """Joins the lines of one paragraph, list line or labelled line; an indented line and an equation stand for themselves."""
    base = min((len(t) - len(t.lstrip()) for _, t in group if t.strip()), default=0)
    item, column = [], base
    for number, line in group:
        text, indent = line.strip(), max(base, len(line) - len(line.lstrip()))
        label = re.match(r"\s*(?:[-*•]|\d+[.)]|\S+(?: \S+)?(?=  ))\s+", line)
        words = re.findall(r"[A-Za-z]{3,}", text)
        equation = " = " in text and 2 * len(words) < len(text.split())
        if not text or label or equation or indent != column:
            yield item
            item, column = [], len(label[0]) if label else base
        if text:
            item.append((number, text[len(label[0].strip()):] if label else text))
        if equation or (indent > base and indent != column and not label):
            yield item
            item = []
    yield item


def sentences(item):
    words, begin = [], 0
    for number, text in item:
        for word in re.sub(r"`[^`]*`", "code", text).split():
            begin = begin or number
            words.append(word)
            if re.search(r"[.?!][)\"'»”]*$", word) and not abbreviation.search(word):
                yield begin, words
                words, begin = [], 0
    if words:
        yield begin, words


problems, advice = [], []
for path in sorted(p for part in ("proto", "fluid", "structure", "coupler", "tests", "cases") for p in (root / part).rglob("*")):
    if path.suffix not in (".hpp", ".cpp", ".proto", ".ts", ".mjs", ".py", ".toml") or "node_modules" in path.parts:
        continue
    grammar = hashes if path.suffix in (".py", ".toml") else slashes
    for group in comments(path.read_text(encoding="utf-8"), grammar):
        said = (sentence for item in items(group) for sentence in sentences(item))
        for at, (number, words) in enumerate(said):
            length = sum(bool(re.search(r"\w", word)) for word in words)
            entry = f"{path.relative_to(root)}:{number}: {length} words: {' '.join(words)}"
            if length > LIMIT:
                problems.append(entry)
            if at == 0 and length > FIRST:
                advice.append(f"first sentence, {entry}")
if advise:
    print("\n".join(advice))
print("\n".join(problems) or f"no sentence of a comment has more than {LIMIT} words")
sys.exit(bool(problems))
