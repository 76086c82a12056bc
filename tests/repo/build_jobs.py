"""The scripts start as many compilers as processors and free memory allow, and always one."""
import pathlib
import subprocess
import sys
import tempfile

root = pathlib.Path(sys.argv[1])
GIB = 1 << 20  # kB


def jobs(place, processors, free_kib, limit="max"):
    """What strake_jobs prints where so many processors and so much free memory are; limit: a container's, in bytes."""
    memory, most = place / "meminfo", place / "memory.max"
    memory.write_text(f"MemTotal:  99999999 kB\nMemFree:  1 kB\nMemAvailable:  {free_kib} kB\n")
    most.write_text(f"{limit}\n")
    words = f'. "{root}/cases/setup.sh"; nproc() {{ echo {processors}; }}; strake_jobs "{memory}" "{most}"'
    return int(subprocess.run(["bash", "-euo", "pipefail", "-c", words], check=True, capture_output=True, text=True).stdout)


with tempfile.TemporaryDirectory() as name:
    place = pathlib.Path(name)
    expected = [((2, 20 * GIB), 2), ((8, 8 * GIB), 5), ((64, 15 * GIB), 10), ((4, GIB), 1), ((4, 0), 1), ((8, 64 * GIB, 6 * GIB * 1024), 4)]
    problems = [f"strake_jobs of {known}: {made}, expected {right}" for known, right in expected if (made := jobs(place, *known)) != right]
print("\n".join(problems) or "compilers as processors and memory allow")
sys.exit(bool(problems))
