"""Whole-command cost of the rigid plate entry: wall seconds, and milliseconds per fluid step and stage.

usage: tests/benchmark/plate_entry.py [BIN_DIR] [--set KEY=VALUE]…     (default: build/bin)
The settings of the cost row: structure rigid, c = 1500 m/s, time step 1e-5 s, 30 ms, one thread."""
import runs

arguments = runs.command(__doc__).parse_args()
summary = runs.run(arguments.bin_dir, runs.ROOT / "cases" / "plate_entry.toml", [
    "structure.solver=rigid", "fluid.scheme.time_step=1e-5", "run.threads=1", *arguments.set]).summary
steps = summary["steps"]["fluid"]
stages = summary["seconds"]["fluid"]
print(f"{summary['particles']['fluid']:.0f} water particles, {steps:.0f} fluid steps, "
      f"{summary['seconds']['wall']:.1f} s wall")
for stage, seconds in sorted(stages.items(), key=lambda item: -item[1]):
    print(f"  {stage:<12} {1e3 * seconds / steps:7.3f} ms per step")
print(f"  {'fluid':<12} {1e3 * sum(stages.values()) / steps:7.3f} ms per step")
memory = {who: value for who, value in summary["peak_memory_bytes"].items() if value}
print("  peak memory  " + ", ".join(f"{who} {value / 2**20:.0f} MiB" for who, value in memory.items()))
