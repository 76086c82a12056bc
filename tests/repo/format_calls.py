"""Texts are made by fmt::format alone.

    tests/repo/format_calls.py ROOT     exits 1 where a source calls for more of fmt, which it then compiles whole

fmt::format is compiled in fmt's library. fmt::join, fmt::format_to, the formats of times and ranges, and a log's own formats are
templates of headers: each source that calls one compiles all formats of numbers, 80 kB and 0.5 to 2.5 s of the compiler's time."""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
INSTEAD = {
    r"fmt::join\b": "joined (proto/visible.hpp) or hexadecimal (proto/text.hpp)",
    r"fmt::v?format_to(?:_n)?\b": "text += fmt::format(…)",
    r"#include <fmt/(?!format\.h|core\.h)": "time_text (proto/text.hpp), fmt::format of each element",
    r"(?:spdlog::|\blog(?:_)?(?:->|\.))(?:trace|debug|info|warn|error|critical)\(\s*\"(?:\\.|[^\"\\])*\"\s*,": "a log's line made by fmt::format",
}
problems = []
for part in ("proto", "fluid", "structure", "coupler"):
    for path in sorted((root / part).rglob("*.[ch]pp")):
        text = path.read_text(encoding="utf-8")
        for call, instead in INSTEAD.items():
            for found in re.finditer(call, text):
                line = text.count("\n", 0, found.start()) + 1
                problems.append(f"{path.relative_to(root)}:{line}: {found.group().split(chr(10))[0]}; better: {instead}")
print("\n".join(problems) or "texts are made by fmt::format alone")
sys.exit(bool(problems))
