"""Man pages and completion from the command line's own declarations: they name every option, and bash completes."""
import pathlib
import re
import shutil
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent))
from processes import *  # noqa: F403: the test's own vocabulary

COMPLETE = """
source "$1"; shift
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))
_strake 2>&1
printf '%s\\n' "${COMPREPLY[@]}"
"""


def long_options(text):
    return set(re.findall(r"(?<![\w-])--[a-z][\w-]*", text))


def help_of(program, *words):
    return subprocess.run([BIN / program, *words, "--help"], capture_output=True, text=True, timeout=60).stdout


def plain(page):
    """The text of a page without the marks of roff."""
    return re.sub(r"\\f[BIR]|\\&", "", page).replace("\\-", "-").replace("\\(ga", "`").replace("\\(dq", '"')


def pages_are_whole(place):
    written = strake("explain", "--man", "man1", cwd=place)
    expect(written.returncode == 0, f"explain --man: exit {written.returncode}\n{written.stderr}")
    pages = {page.stem: plain(page.read_text()) for page in (place / "man1").glob("*.1")}
    programs = [p.name for p in BIN.glob("strake*") if p.name.startswith("strake")]
    commands = re.findall(r"^  ([a-z]+)  ", help_of("strake").partition("Subcommands:")[2], re.M)
    expect(len(commands) > 12, f"commands {commands}")
    for program in programs:
        expect(program in pages, f"{program} has a page")
        lacks = long_options(help_of(program)) - long_options(pages.get(program, ""))
        expect(not lacks, f"{program}.1 has all options {lacks}")
    for command in commands:
        page = pages.get(f"strake-{command}", "")
        lacks = long_options(help_of("strake", command).partition("\n")[2]) - long_options(page)
        expect(page and not lacks, f"strake-{command}.1 has all options {lacks}")
        expect(f"strake-{command} (1)" in pages["strake"], f"strake.1 leads to strake-{command}")
    expect({"--angle", "--mesh", "--radius"} <= long_options(pages["strake-new"]), "strake-new.1 has the options of its kinds")
    table = re.findall(r"^\| ([\d, ]+) \| (.+) \|$", (ROOT / "proto/README.md").read_text(), re.M)
    lacks = [row for row in table if f".TP\n{row[0].strip()}\n{row[1]}\n" not in pages["strake"]]
    expect(len(table) > 8 and not lacks, f"the exit codes are those of proto/README.md {lacks}")
    return sorted(str(page) for page in (place / "man1").glob("*.1"))


def pages_are_roff(files):
    checks = (("mandoc", ["-T", "lint", "-W", "warning"]), ("groff", ["-man", "-ww", "-z"]))
    for program, words in checks:
        if shutil.which(program):
            result = subprocess.run([program, *words, *files], capture_output=True, text=True, timeout=60)
            said = (result.stdout + result.stderr).strip()
            expect(result.returncode == 0 and not said, f"{program} finds nothing in {len(files)} pages {said[:2000]}")
            return
    print("skip  man pages are not checked: neither mandoc nor groff is installed (Debian: apt install mandoc)")


class Bash:
    def __init__(self, place):
        self.place, self.script = place, place / "strake.bash"
        written = strake("explain", "--completion", "bash", cwd=place)
        self.script.write_text(written.stdout)
        checked = subprocess.run(["bash", "-n", self.script], capture_output=True, text=True)
        expect(written.returncode == 0 and checked.returncode == 0, f"bash reads the script {checked.stderr}")

    def __call__(self, *words):
        """What bash offers for the last word; "=" is a word of its own, as bash breaks a line."""
        result = subprocess.run(["bash", "-c", COMPLETE, "bash", self.script, *words], cwd=self.place, capture_output=True, text=True,
                                timeout=20)
        return [line for line in result.stdout.splitlines() if line]


def offers(bash, words, wanted, exactly=False):
    found = bash(*words)
    fits = set(found) == set(wanted) if exactly else set(wanted) <= set(found)
    expect(fits, f"{' '.join(words)}| offers {sorted(wanted)}: {found[:12]}")


def bash_completes(place):
    for name in ("ship.toml", "notes.txt", "runs/one/run.json", "runs/two/run.json", "runs/three/x", "made/four/run.json", "a b.toml"):
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        (place / name).touch()
    bash = Bash(place)
    offers(bash, ("strake", "r"), {"run", "report", "replay"}, exactly=True)
    offers(bash, ("strake", "--v"), {"--version"}, exactly=True)
    offers(bash, ("/usr/bin/strake", "run", "--re"), {"--resume"}, exactly=True)
    offers(bash, ("strake", "run", "sh"), {"ship.toml"}, exactly=True)
    offers(bash, ("strake", "run", "a"), {"a b.toml"}, exactly=True)
    offers(bash, ("strake", "run", "n"), set(), exactly=True)
    offers(bash, ("strake", "run", "--attach", "f"), {"fluid"}, exactly=True)
    offers(bash, ("strake", "run", "--attach", "=", "b"), {"both"}, exactly=True)
    offers(bash, ("strake", "run", "--tag", "x", "ship.toml", "--st"), {"--strict"}, exactly=True)
    offers(bash, ("strake", "picture", ""), {"runs/one", "runs/two"}, exactly=True)
    offers(bash, ("strake", "report", "runs/t"), {"runs/two"}, exactly=True)
    offers(bash, ("strake", "watch", "made/"), {"made/four"}, exactly=True)
    offers(bash, ("strake", "new", ""), {"plate", "wedge", "mesh"})
    offers(bash, ("strake", "new", "wedge", "--an"), {"--angle"}, exactly=True)
    offers(bash, ("strake", "new", "plate", "--solver", ""), {"fem", "particle", "rigid"}, exactly=True)
    offers(bash, ("strake", "run", "--set", "fluid.spac"), {"fluid.spacing="}, exactly=True)
    offers(bash, ("strake", "run", "--set", "structure.solver", "=", "r"), {"rigid", "replay"}, exactly=True)
    offers(bash, ("strake", "check", "ship.toml", "--set", "output.probe[2].of", "=", ""), {"fluid", "structure"}, exactly=True)
    offers(bash, ("strake", "run", "--set", "a", "=", "b", "--set", "fluid.air.layer", "=", "t"), {"true"}, exactly=True)
    offers(bash, ("strake", "explain", "coupling.surface.win"), {"coupling.surface.window"}, exactly=True)
    offers(bash, ("strake", "export", "--to", ""), {"ccx", "ansys"}, exactly=True)
    offers(bash, ("strake-fluid", "--ch"), {"--check"}, exactly=True)
    offers(bash, ("strake-structure-rigid", "--check", "sh"), {"ship.toml"}, exactly=True)
    offers(bash, ("strake", ""), {"run", "study", "new", "import"})


def refusals_help(place):
    (place / "file").touch()
    for words, code in (("--completion fish", 2), ("--man x --schema", 2), ("--man file/man1", 6)):
        refused = strake("explain", *words.split(), cwd=place)
        expect(refused.returncode == code and refused.stderr, f"explain {words}: exit {refused.returncode}, {refused.stderr.strip()}")


with folder() as name:
    here = pathlib.Path(name)
    pages_are_roff(pages_are_whole(here))
    bash_completes(here)
    refusals_help(here)
finish()
