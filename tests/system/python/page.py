"""The page coupler/python/README.md. Its blocks run one after the other and print what stands under them: page.py ROOT BIN
[--write]. Numbers may differ by one part in a thousand. --write puts in what they print, and the files that it shows."""
import contextlib
import io
import os
import pathlib
import re
import sys
import tempfile
import traceback

ROOT, BIN = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
PAGE = ROOT / "coupler" / "python" / "README.md"
BLOCK = re.compile(r"(?:<!-- (file|needs): (\S+) -->\n)?```python\n(.*?)```\n(?:\n```text\n(.*?)```\n)?", re.S)
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]\d+)?")
CLOSE = 1e-3  # relative: numbers of a run differ with the machine's instructions


def same(printed, expected):
    """Whether two texts are one but for the last digits of their numbers."""
    if NUMBER.sub("0", printed) != NUMBER.sub("0", expected):
        return False
    pairs = zip(NUMBER.findall(printed), NUMBER.findall(expected))
    return all(abs(float(a) - float(b)) <= CLOSE * max(abs(float(a)), abs(float(b))) for a, b in pairs)


def lacks(module):
    try:
        __import__(module)
    except ImportError:
        print(f"      skipped: {module} is not installed")
        return True
    return False


def main():
    sys.path.insert(0, str(BIN.parent / "python"))
    os.environ.update(STRAKE_BIN=str(BIN), OMP_NUM_THREADS="1")
    text, names, failed, made = PAGE.read_text(encoding="utf-8"), {}, 0, []
    for found in BLOCK.finditer(text):
        what, value, code, expected = found.groups()
        line, ok = text.count("\n", 0, found.start()) + 1, True
        if what == "file":
            shown = (ROOT / value).read_text(encoding="utf-8")
            ok, printed = shown == code, "the file has another text\n"
            made.append((found.span(3), shown))
        elif not (what == "needs" and lacks(value)):
            output = io.StringIO()
            with contextlib.redirect_stdout(output):
                try:
                    exec(compile("\n" * line + code, str(PAGE), "exec"), names)
                except Exception:
                    traceback.print_exc(file=sys.stdout)
            printed = output.getvalue()
            ok = same(printed, expected or "")
            made += [(found.span(4), printed)] if expected is not None else []
        print(f"{'ok  ' if ok else 'FAIL'}  {PAGE.name}:{line}" + ("" if ok else f"\n--- expected\n{expected}--- printed\n{printed}"), flush=True)
        failed += not ok
    if "--write" in sys.argv:
        for (begin, end), new in reversed(made):
            text = text[:begin] + new + text[end:]
        PAGE.write_text(text, encoding="utf-8")
    print(f"{failed} failed of {len(BLOCK.findall(text))} blocks")
    return bool(failed)


with tempfile.TemporaryDirectory(prefix="strake-test-") as place:
    os.symlink(ROOT / "cases", pathlib.Path(place) / "cases")
    os.chdir(place)
    code = main()
    os.chdir("/")
sys.exit(code)
