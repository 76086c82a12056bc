"""The JSON Schema of the case file accepts every case and its own defaults. It sees the wrong cases that it can."""
import json
import math
import pathlib
import sys
import tomllib

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent))
from processes import *  # noqa: F403: the test's own vocabulary

try:
    import jsonschema
except ImportError:
    print("skip  jsonschema is not installed (Debian: apt install python3-jsonschema)")
    sys.exit(0)

# What tests/text/case_errors.txt holds that a schema can see: place of the error, and the rule that it breaks.
SEEN = {
    "a number with a unit": ("structure.material.young", "type"),
    "a number in quotes": ("structure.material.young", "type"),
    "a number out of range": ("structure.material.young", "minimum"),
    "a number above its range": ("fluid.scheme.cfl", "maximum"),
    "infinity where none is allowed": ("fluid.scheme.cfl", "maximum"),
    "a misspelt key": ("fluid", "additionalProperties"),
    "a misspelt table and its neighbours": ("", "additionalProperties"),
    "a key that is like no other": ("structure", "additionalProperties"),
    "an unknown key at the root": ("", "additionalProperties"),
    "a table where a value belongs": ("fluid.scheme.cfl", "type"),
    "a value where a table belongs": ("fluid.scheme", "type"),
    "one table where a list of tables belongs": ("compare", "type"),
    "a list of tables where one table belongs": ("structure", "type"),
    "a vector of one component": ("fluid.gravity", "minItems"),
    "a vector with something else in it": ("fluid.gravity.1", "type"),
    "a box with a short corner": ("fluid.tank.1", "minItems"),
    "a box that is none": ("fluid.tank", "type"),
    "a flag that is a number": ("fluid.scheme.negative_pressure", "type"),
    "a whole number that is not whole": ("structure.fem.degree", "type"),
    "a whole number far too large": ("structure.fem.degree", "maximum"),
    "a choice with a slip": ("structure.solver", "anyOf"),
    "a choice like no other": ("structure.material.model", "enum"),
    "a choice that is a number": ("structure.solver", "type"),
    "a list of texts with a number in it": ("structure", "additionalProperties"),  # parts is a key of that test alone
    "a required key without its table": ("", "required"),
    "a required key in a table": ("fluid", "required"),
    "a required key of the root": ("", "required"),
    "a required key in an element of a list": ("compare.0", "required"),
    "an unknown key in an element of a list": ("compare.0", "additionalProperties"),
    "a key with a dot that stands without quotes": ("compare.0.when.structure", "anyOf"),
    "an unknown preset": ("preset", "enum"),
    "a date where a text belongs": ("title", "type"),
    "a caret behind a tab and letters of two bytes": ("structure", "additionalProperties"),
    "a long line": ("fluid.gravity", "maxItems"),
}
# What it cannot see, and why.
UNSEEN = {
    "not a number": "JSON has no nan; taplo hands over null, as for inf, which sound_speed may be",
    "a vector with not-a-number on a line of its own": "JSON has no nan; with taplo's null it is seen",
    "a box with its corners exchanged": "two values have to agree",
    "a choice that is not built yet": "the choice exists in the programs, not in that test",
    "a key that is not built yet": "the key exists in the programs, not in that test",
    "a probe whose name breaks a column": "a check beside the declaration",
    "two probes of one name": "two values have to agree",
    "a probe of the fluid that deflects": "two values have to agree",
}


def is_study(text):
    return "[[axis]]" in text


def place_of(error):
    return ".".join(str(part) for part in error.absolute_path)


def found(validator, case):
    return {(place_of(error), error.validator) for error in validator.iter_errors(case)}


def as_taplo(value):
    """inf and nan as editors with taplo hand them to a schema: null."""
    if isinstance(value, dict):
        return {key: as_taplo(part) for key, part in value.items()}
    if isinstance(value, list):
        return [as_taplo(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def wrong_cases():
    """Name and text of each block of the list of errors; a block that starts with --set is none of a file."""
    blocks = (ROOT / "tests/text/case_errors.txt").read_text().split("\n==== ")[1:]
    for block in blocks:
        name, _, rest = block.partition("\n")
        text, _, after = rest.partition("\n----")
        if not after.startswith(" set"):
            yield name, text + "\n"


def cases_validate(validator):
    files = [*(ROOT / "cases").glob("*.toml"), *(ROOT / "cases").glob("*/*.toml")]
    cases = [f for f in files if not is_study(f.read_text())]
    expect(len(cases) > 30, f"{len(cases)} cases are looked at")
    for file in cases:
        case = tomllib.loads(file.read_text())
        errors = found(validator, case) | found(validator, as_taplo(case))
        expect(not errors, f"{file.name} validates {sorted(errors)}")


def defaults_validate(schema, where="", definitions=None):
    """Each default of a key passes that key's own rules: the number of defaults looked at."""
    count = 0
    for name, key in schema.get("properties", {}).items():
        if "default" in key:
            count += 1
            errors = list(jsonschema.Draft7Validator(key).iter_errors(key["default"]))
            expect(not errors, f"the default of {where}{name} passes: {key['default']}")
        count += defaults_validate(key.get("items", key), f"{where}{name}.")
    return count


def errors_are_seen(validator):
    names = set()
    for name, text in wrong_cases():
        names.add(name)
        try:
            case = tomllib.loads(text)
        except tomllib.TOMLDecodeError:
            expect(name not in SEEN and name not in UNSEEN, f"{name}: no TOML, so no schema is asked")
            continue
        errors = found(validator, case)
        if name in SEEN:
            expect(SEEN[name] in errors, f"{name}: {SEEN[name]} in {sorted(errors)}")
        else:
            expect(name in UNSEEN, f"{name}: stands in one of the two lists of this test")
            expect(errors <= {("fluid", "required")}, f"{name}: not seen, {UNSEEN.get(name)} {sorted(errors)}")
    expect(names >= SEEN.keys() | UNSEEN.keys(), f"no list names what is gone {SEEN.keys() | UNSEEN.keys() - names}")


def conditions_hold(validator):
    """Tables that another program reads, keys that stand in for others, and older names."""
    fluid = {"spacing": 0.01, "tank": [[0, 0], [1, 1]], "water": [[0, 0], [1, 0.5]]}

    def errors(case):
        return found(validator, {"end_time": 1.0, **case})
    expect(not errors({"fluid": fluid}), "a small case validates")
    for gone in fluid:
        less = {key: value for key, value in fluid.items() if key != gone}
        expect(("fluid", "required") in errors({"fluid": less}), f"fluid.{gone} is required")
        expect(not errors({"fluid": {**less, "solver": "none"}}), f"fluid.{gone} is not required without water")
    corners = [[0, 0], [1, 0], [1, 1]]
    expect(not errors({"fluid": {"spacing": 0.01, "tank_polygon": corners, "water_polygon": corners}}), "polygons stand in for boxes")
    expect(("fluid.tank_polygon", "minItems") in errors({"fluid": {**fluid, "tank_polygon": corners[:2]}}), "a polygon has three corners")
    own = {"solver": "./mine.py", "mine": {"stiffness": 3}, "material": {"of_mine": True}}
    expect(not errors({"fluid": fluid, "structure": own}), "a program of the user's has its own keys")
    expect(errors({"fluid": fluid, "structure": {**own, "solver": "fem"}}), "a solver of Strake has not")
    expect(not errors({"fluid": {"solver": "replay", "replay": {"run": "runs/x"}, "anything": 1}}), "a replayed fluid skips the water's keys")
    expect(not errors({"fluid": {**fluid, "sound_speed": float("inf")}}), "inf is a sound speed")
    expect(not errors({"fluid": fluid, "compare": [{"probe": "a", "when": {"structure.solver": ["fem", "rigid"]}}]}), "when takes any key")


with folder() as place:
    result = strake("explain", "--schema", cwd=place)
    expect(result.returncode == 0, f"explain --schema: exit {result.returncode}\n{result.stderr}")
    schema = json.loads(result.stdout)
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    cases_validate(validator)
    defaults = sum(defaults_validate(part, name + ".") for name, part in [*schema["definitions"].items(), ("root", schema)])
    expect(defaults > 100, f"{defaults} defaults are looked at")
    errors_are_seen(validator)
    conditions_hold(validator)
    nan = found(validator, {"end_time": 1.0, "fluid": {"solver": "none", "gravity": [1, 2, None]}})
    expect(("fluid.gravity.2", "type") in nan, f"taplo's null is no component of a vector {nan}")
    old = schema["definitions"]["structure_keys"]["properties"]["wet"]
    expect(old.get("deprecated") is True and "loaded_faces" in old["description"], f"an older name is marked {old}")
    no_key = strake("explain", "--schema", "fluid", cwd=place)
    expect(no_key.returncode == 2, "explain --schema takes no key")
finish()
