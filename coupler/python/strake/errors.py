"""What goes wrong, with where, what and how to mend it."""


class Error(Exception):
    """An error that a user, a file or a program of Strake can cause.

    problem    what is wrong, with the value found and the value expected; or the program's own words
    fix        what the user can change; may be empty
    where      the file, key or place; may be empty
    exit_code  the code of proto/README.md, "Exit codes", that a program ends with; 4: a solver gave up
    run        of strake.run: the run as far as it went, opened; None where it did not begin
    """

    run = None

    def __init__(self, problem, fix="", where="", exit_code=4):
        super().__init__(problem)
        self.problem, self.fix, self.where, self.exit_code = str(problem), fix, str(where), exit_code

    def __str__(self):
        text = f"{self.where}: {self.problem}" if self.where else self.problem
        return text + (f"\n  fix: {self.fix}" if self.fix else "")


class RetrySmallerStep(Exception):
    """Raised in `Participant.advance`: the window shall be tried again, no longer than `limit` [s].

    why   the reason, one line; the coupler prints it where no window is short enough
    fix   what a user may change, one line
    """

    def __init__(self, limit, why="", fix=""):
        super().__init__(why)
        self.limit, self.why, self.fix = limit, why, fix


def need(module, package):
    """Imports a module that Debian has in a package of its own; Error with that package's name where it lacks."""
    import importlib
    try:
        return importlib.import_module(module)
    except ImportError as e:
        raise Error(f"the Python module {module} is not there ({e})", f"apt-get install {package}", exit_code=2) from None


def nearest(word, known):
    """The end of a message about an unknown name: ' (did you mean "mid.y"?)', or all names."""
    import difflib
    known = list(known)
    close = [k for k in known if k.startswith(word + ".")] or difflib.get_close_matches(word, known, 1, 0.5)
    if close:
        return f'did you mean "{close[0]}"?'
    return "there are " + ", ".join(known) if known else "there are none"
