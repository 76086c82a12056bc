"""Whole-command cost of the rigid plate entry: wall seconds, and milliseconds per fluid step and stage.

usage: tests/benchmark/plate_entry.py [BIN_DIR] [--set KEY=VALUE]…     (default: build/bin)
The settings of the cost row: structure rigid, c = 1500 m/s, time step 1e-5 s, 30 ms, one thread."""
import json
import pathlib
import subprocess
import sys
import tempfile

root = pathlib.Path(__file__).resolve().parents[2]
words = sys.argv[1:]
bin_dir = pathlib.Path(words.pop(0)) if words and not words[0].startswith("--") else root / "build" / "bin"
with tempfile.TemporaryDirectory() as place:
    command = [str(bin_dir / "strake"), "run", str(root / "cases" / "plate_entry.toml"), "--quiet", "--set",
               "structure.solver=rigid", "--set", "fluid.scheme.time_step=1e-5", "--set", "run.threads=1", *words]
    subprocess.run(command, cwd=place, check=True, stdout=subprocess.DEVNULL)
    run = next(pathlib.Path(place).glob("runs/*"))
    summary = json.loads((run / "summary.json").read_text())
steps = summary["steps"]["fluid"]
stages = summary["seconds"]["fluid"]
print(f"{summary['particles']['fluid']:.0f} water particles, {steps:.0f} fluid steps, "
      f"{summary['seconds']['wall']:.1f} s wall")
for stage, seconds in sorted(stages.items(), key=lambda item: -item[1]):
    print(f"  {stage:<12} {1e3 * seconds / steps:7.3f} ms per step")
print(f"  {'fluid':<12} {1e3 * sum(stages.values()) / steps:7.3f} ms per step")
memory = {who: value for who, value in summary["peak_memory_bytes"].items() if value}
print("  peak memory  " + ", ".join(f"{who} {value / 2**20:.0f} MiB" for who, value in memory.items()))
