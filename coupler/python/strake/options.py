"""The command line of a participant (proto/WIRE.md), and what the case says for it."""
import os
import pathlib
import sys
import tomllib

from .errors import Error, nearest

USAGE = "strake run CASE starts this program; it is the solver that the case names"


class Options:
    """Endpoint, name and case of one participant, from its command line and the environment.

    endpoint, name, case_hash, token, key_file   texts of --connect, --name, --case-hash, STRAKE_TOKEN, STRAKE_KEY
    case                                         the case file as a dict, with every --set
    side, body                                   "fluid", "structure" or "attachment"; of several bodies the name of this one, else ""
    stem                                         name of the program without its ending: its table is [<name>.<stem>]
    """

    def __init__(self, arguments=None, program=None):
        arguments = sys.argv[1:] if arguments is None else list(arguments)
        self.stem = pathlib.Path(program or sys.argv[0]).stem
        given, sets = {}, []
        for name, value in pairs(arguments):
            if name == "--set":
                sets.append(value)
            else:
                given[name] = value
        environment = os.environ
        self.endpoint = given.get("--connect") or environment.get("STRAKE_CONNECT", "")
        self.name = given.get("--name") or environment.get("STRAKE_NAME", "")
        self.case_hash = given.get("--case-hash") or environment.get("STRAKE_CASE_HASH", "")
        self.body = given.get("--body", "")
        self.token, self.key_file = environment.get("STRAKE_TOKEN", ""), environment.get("STRAKE_KEY", "")
        for what, value in (("--connect", self.endpoint), ("--name", self.name), ("--case-hash", self.case_hash)):
            if not value:
                raise Error(f"{what} is missing", USAGE, exit_code=2)
        self.case_file, self.sets = given.get("--case", ""), sets
        self.side = "fluid" if self.name == "fluid" else "structure"
        if not self.body and self.name not in ("fluid", "structure") and self.attached_in(self.read_case()) is not None:
            self.side = "attachment"

    def read_case(self):
        """The case file with every --set; an empty dict where no file is named. Error where it cannot be read."""
        if not self.case_file:
            return {}
        try:
            with open(self.case_file, "rb") as file:
                case = tomllib.load(file)
        except (OSError, tomllib.TOMLDecodeError) as e:
            raise Error(f"cannot be read: {e}", "", self.case_file, 3) from None
        for text in self.sets:
            set_key(case, text)
        if self.body:  # its [[structures]] stands as [structure], as for Strake's own programs
            own = [table for table in case.get("structures", []) if table.get("name") == self.body]
            if not own:
                raise Error(f"has no body {self.body}", "--body names one of [[structures]]", self.case_file, 3)
            case["structure"] = own[0]
        return case

    def attached_in(self, case):
        """The one of [[attachments]] that this program computes, or None."""
        return next((one for one in case.get("attachments", []) if one.get("name") == self.name), None)

    def own_keys(self, case):
        """The table [<side>.<stem>] of a case, which Strake does not read. A key that is not there is an Error."""
        if self.side == "attachment":
            return Keys(self.attached_in(case).get(self.stem, {}), f"attachments.{self.name}.{self.stem}", self.case_file)
        table = f"structures.{self.body}" if self.body else self.side
        return Keys(case.get(self.side, {}).get(self.stem, {}), f"{table}.{self.stem}", self.case_file)


class Keys(dict):
    """A table of the case; a missing key is answered with its full name and the nearest one."""

    def __init__(self, table, path, case_file):
        super().__init__(table)
        self.path, self.case_file = path, case_file

    def __missing__(self, key):
        raise Error(f"has no key {self.path}.{key}; {nearest(key, self)}", f"write it into the table [{self.path}]", self.case_file, 3)


def pairs(arguments):
    if len(arguments) % 2 or not all(a.startswith("--") for a in arguments[::2]):
        raise Error("the command line is not that of a participant: " + " ".join(arguments)[:200], USAGE, exit_code=2)
    return zip(arguments[::2], arguments[1::2])


def set_key(case, text):
    """Sets one key of a case as --set KEY=VALUE does; a value that is no TOML is a text."""
    path, _, value = text.partition("=")
    try:
        value = tomllib.loads("value = " + value)["value"]
    except tomllib.TOMLDecodeError:
        pass
    *tables, key = path.split(".")
    for table in tables:
        if isinstance(case, list):  # [[structures]], by name
            case = next((body for body in case if body.get("name") == table), {})
            continue
        below = case.get(table)
        if isinstance(below, list):
            case = below
            continue
        if not isinstance(below, dict):
            below = case[table] = {}
        case = below
    case[key] = value
