"""A study from its file to its table: runs done, skipped, resumed and refused, and records compared with each other."""
import json
import os
import re
import shutil
import signal

from processes import *  # noqa: F403: the test's own vocabulary

STUDY = f"""title = "strip"
case = "{ROOT / 'cases' / 'cantilever.toml'}"
[[axis]]
name = "solver"
value = [{{ label = "fem", set = ["structure.solver=fem"] }}, {{ label = "particle", set = ["structure.solver=particle"] }}]
[[axis]]
name = "cells"
value = [{{ label = "r0", at = 4, set = ["structure.fem.refinement=0"] }}, {{ label = "r1", at = 2, set = ["structure.fem.refinement=1"] }},
         {{ label = "r2", at = 1, set = ["structure.fem.refinement=2"] }}]
[[exclude]]
where = ["solver!=fem", "cells!=r2"]
[[column]]
probe = "tip.y"
metric = "final"
[[check]]
axis = "solver"
of = "particle"
against = "fem"
probe = "tip.y"
metric = "final"
tolerance = 0.05
[[convergence]]
axis = "cells"
probe = "tip.y"
metric = "final"
where = ["solver=fem"]
"""


def table_of(place):
    return json.loads((place / "runs" / "strip" / "study.json").read_text())


def runs_all_then_nothing(place):
    (place / "strip.toml").write_text(STUDY)
    listed = strake("study", "strip.toml", "--list", cwd=place)
    for command in ("check", "run"):
        told = strake(command, "strip.toml", cwd=place)
        expect(told.returncode == 3 and "is a study, not a case" in told.stderr and "strake study strip.toml" in told.stderr, f"{command} of a study says so\n{told.stderr}")
    (place / "above.toml").write_text(STUDY.replace('case = "', 'case = "strip.toml"  # "', 1))
    told = strake("study", "above.toml", "--list", cwd=place)
    expect(told.returncode == 3 and "strip.toml is a study" in told.stderr, f"a study of a study is refused before its runs\n{told.stderr}")
    expect(listed.returncode == 0 and listed.stdout.count("strake run") == 4, f"--list prints four commands\n{listed.stdout}{listed.stderr}")
    expect(not (place / "runs").exists(), "--list starts nothing")
    result = strake("study", "strip.toml", cwd=place)
    expect(result.returncode == 0, f"study: exit {result.returncode}\n{result.stdout}{result.stderr}")
    table = table_of(place)
    expect([run["state"] for run in table["runs"]] == ["done"] * 4, "all four runs are done")
    for run in table["runs"]:
        summary = json.loads((place / "runs" / "strip" / run["folder"] / "summary.json").read_text())
        expect(run["values"]["tip.y:final"] == summary["probes"]["tip.y"]["final"], f"{run['name']}: the table has the run's own number")
    check = table["checks"][0]
    expect(check["run"] == "particle-r2" and check["against"] == "fem-r2", "the check holds particle against fem")
    wanted = (check["value"] - check["reference"]) / abs(check["reference"])
    expect(abs(check["deviation"] - wanted) < 1e-12 and check["pass"] == (abs(wanted) <= 0.05), "its deviation follows from its values")
    expect(table["convergence"][0]["order"] and 1 < table["convergence"][0]["order"] < 3, f"order {table['convergence'][0]['order']}")
    cores, first = os.cpu_count(), json.loads((place / "runs" / "strip" / "cantilever-fem-r0" / "run.json").read_text())
    expect(first["threads"] == max(1, cores // min(cores, 4)), f"runs at once share the cores: {first['threads']} threads of {cores} cores")
    lines = (place / "runs" / "strip" / "study.csv").read_text().splitlines()
    expect(lines[1] == "run,solver,cells,state,seconds [s],tip.y:final [m]" and len(lines) == 6, "study.csv has a row for each run")
    before = (place / "runs" / "strip" / "cantilever-fem-r0" / "run.json").read_bytes()
    (place / "strip.toml").write_text(STUDY.replace("[[check]]", '[[column]]\nprobe = "tip.y"\nmetric = "impulse"\n[[check]]'))
    again = strake("study", "strip.toml", cwd=place)
    expect("impulse: of the first 300 us after contact" in again.stdout and "impulse:" not in result.stdout, f"an impulse is explained\n{again.stdout}")
    expect(again.stdout.count("done before") == 4, f"a second study runs nothing\n{again.stdout}")
    expect((place / "runs" / "strip" / "cantilever-fem-r0" / "run.json").read_bytes() == before, "and touches nothing")
    (place / "strip.toml").write_text(STUDY.replace('"structure.fem.refinement=0"', '"structure.fem.refinement=0", "structure.material.young=1e11"'))
    changed = strake("study", "strip.toml", cwd=place)
    expect(changed.stdout.count("done before") == 3, f"a changed choice is run again, the others are not\n{changed.stdout}")


def a_run_that_fails_leaves_the_others(place):
    (place / "bad.toml").write_text(STUDY.replace('set = ["structure.solver=particle"]', 'set = ["structure.material.poisson=0.5"]'))
    result = strake("study", "bad.toml", cwd=place)
    expect(result.returncode == 3, f"the exit code is that of the run that failed, not {result.returncode}")
    expect("poisson" in result.stdout and "3 of 4 runs" in result.stdout, f"it is named with its error\n{result.stdout}")
    expect("FAIL" not in result.stdout
           and re.search(r"^  no run +particle-r2 tip.y final: particle-r2 has failed \(within 5 %\) +fem-r2", result.stdout, re.M),
           f"its check says that there is no run\n{result.stdout}")


def goes_on_after_ctrl_c(place):
    slow = STUDY.replace("cantilever.toml", "still_tank.toml").replace("structure.solver=fem", "run.checkpoint=0.2").replace(
        "structure.solver=particle", "run.checkpoint=0.3")
    slow = slow.replace("[[axis]]", 'set = ["end_time=0.4"]\n[[axis]]', 1)
    slow = slow[:slow.index("[[axis]]\nname = \"cells\"")]
    (place / "slow.toml").write_text(slow + '[[column]]\nprobe = "never"\nmetric = "peak"\n')  # a missing run may have it
    study = start("study", "slow.toml", cwd=place)
    history = place / "runs" / "slow" / "still_tank-fem" / "history.csv"
    expect(wait_until(lambda: history.exists() and history.stat().st_size > 4000, 60), "the first run has come some way")
    study.send_signal(signal.SIGINT)
    out, _ = study.communicate(timeout=60)
    expect(study.returncode == 130, f"Ctrl-C: exit {study.returncode}\n{out}")
    expect("keep what they have" in out, "it says that runs keep what they have")
    (place / "slow.toml").write_text(slow)
    again = strake("study", "slow.toml", cwd=place)
    expect(again.returncode == 0, f"the same command goes on: exit {again.returncode}\n{again.stdout}{again.stderr}")
    record = json.loads((place / "runs" / "slow" / "still_tank-fem" / "run.json").read_text())
    expect("resumed_at" in record, "the run went on from its checkpoint")


def wrong_files_are_refused(place):
    for change, words in (((("metric = \"final\"\ntolerance", "metric = \"final\"\ntolernce")), "tolernce"),
                          (("of = \"particle\"", "of = \"particel\""), "a label of axis solver: fem, particle"),
                          (("title = \"strip\"", "titel = \"strip\""), "titel is not a key"),
                          (("case = \"", "case = \"nowhere"), "nowhere")):
        (place / "wrong.toml").write_text(STUDY.replace(*change))
        result = strake("study", "wrong.toml", cwd=place)
        expect(result.returncode == 3 and words in result.stderr, f"refused with {words}\n{result.stderr}")
        expect("Traceback" not in result.stderr and not (place / "runs" / "wrong").exists(), "and nothing is made")


def records_beside_each_other(place):
    tank = ROOT / "cases" / "still_tank.toml"
    strake("run", tank, "--set", "end_time=0.05", cwd=place)
    strake("run", tank, "--set", "end_time=0.05", "--set", "fluid.gravity=[0,-9.0,0]", "--tag", "moon", cwd=place)
    one, two = "runs/still_tank", "runs/still_tank-moon"
    result = strake("compare", one, two, "--probe", "p_bottom", "--within", "final=0.2", "--csv", "both.csv", cwd=place)
    expect(result.returncode == 0 and "pass  p_bottom final" in result.stdout, f"compare two runs\n{result.stdout}{result.stderr}")
    expect((place / "both.csv").read_text().splitlines()[3].startswith("time [s],p_bottom(1) [Pa],p_bottom(2) [Pa]"), "the overlay has both")
    narrow = strake("compare", one, two, "--probe", "p_bottom", "--within", "final=1e-3", cwd=place)
    expect(narrow.returncode == 1 and "FAIL" in narrow.stdout, "outside its limit it exits 1")
    (place / "ansys.csv").write_text("time [ms],uy [mm],v [m/s]\n0,0,1\n1,-2.0,1\n2,-1,1\n")
    (place / "test.csv").write_text("t [s],w [m]\n0,0\n0.001,-0.0021\n0.002,-0.001\n")
    other = strake("compare", "ansys.csv:uy", "test.csv", "--within", "peak=0.06", cwd=place)
    expect(other.returncode == 0 and "+5 %" not in other.stdout and "-5 %" in other.stdout, f"two CSV files in their own units\n{other.stdout}{other.stderr}")
    for words, wanted in ((("--within", "finale=1"), "did you mean final"), (("--within", "final"), "METRIC=PART"),
                          (("--shift", "x"), "no time"), (("--probe", "p_botom"), "did you mean p_bottom")):
        result = strake("compare", one, two, *words, cwd=place)
        expect(result.returncode in (2, 3) and wanted in result.stderr, f"{' '.join(words)} is refused\n{result.stdout}{result.stderr}")
    alone = strake("compare", one, "--from", "1e-3", cwd=place)
    expect(alone.returncode == 2 and "for two records" in alone.stderr, f"options of two records want two\n{alone.stderr}")


def the_page_has_every_key(place):
    page = (ROOT / "proto" / "STUDY_FILE.md").read_text()
    source = (ROOT / "coupler" / "study" / "case" / "read_plan.cpp").read_text()
    keys = set(re.findall(r'(?:table|root)\.(?:text|texts|number|integer|choice|file|tables|table)\(\s*"(\w+)"', source))
    missing = [key for key in keys if not re.search(rf"`(\[\[|value\.)?{key}(\]\])?`", page)]
    expect(len(keys) > 20 and not missing, f"proto/STUDY_FILE.md has all {len(keys)} keys, missing {missing}")
    example = page.partition("```toml\n")[2].partition("```")[0]
    shutil.copy(ROOT / "cases" / "plate_entry.toml", place)
    (place / "example.toml").write_text(example)
    listed = strake("study", "example.toml", "--list", cwd=place)
    expect(listed.returncode == 0 and listed.stdout.count("strake run") == 4, f"its example is a study of four runs\n{listed.stdout}{listed.stderr}")


def an_unknown_column_is_an_error(place):
    study = STUDY.partition("[[exclude]]")[0]
    (place / "strip.toml").write_text(study + '[[column]]\nprobe = "tip.y"\nmetric = "finall"\n')
    metric = strake("study", "strip.toml", cwd=place)
    expect(metric.returncode == 3 and 'did you mean "final"' in metric.stderr and not (place / "runs").exists(),
           f"an unknown metric is refused before the first run\n{metric.stderr}")
    (place / "strip.toml").write_text(STUDY.replace('[[column]]\nprobe = "tip.y"', '[[column]]\nprobe = "tipp.y"'))
    probe = strake("study", "strip.toml", cwd=place)
    expect(probe.returncode == 3 and 'did you mean "tip.y"' in probe.stderr, f"an unknown probe is an error\n{probe.stderr}")
    expect(len(table_of(place)["runs"]) == 4, "after the table is written")


for test in (the_page_has_every_key, an_unknown_column_is_an_error, runs_all_then_nothing, a_run_that_fails_leaves_the_others, goes_on_after_ctrl_c, wrong_files_are_refused,
             records_beside_each_other):
    with folder() as place:
        test(pathlib.Path(place))
finish()
