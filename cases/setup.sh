# Shared by cases/run.sh and tests/run.sh: what Strake needs from Debian, and one build folder for both.
# Sourced, not run. Sets nothing outside the names strake_*.

strake_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
strake_build=${STRAKE_BUILD:-$strake_root/build}

strake_packages_build="g++ cmake ninja-build ccache pkg-config libeigen3-dev libsuitesparse-dev libopenblas-dev
  libdeal.ii-dev libprotobuf-dev protobuf-compiler libzmq3-dev cppzmq-dev libhdf5-dev libtomlplusplus-dev libcli11-dev
  libfmt-dev libspdlog-dev nlohmann-json3-dev libsodium-dev libexpat1-dev libzip-dev libspectra-dev libnanoflann-dev libcairo2-dev libcpp-httplib-dev"
strake_packages_python="python3 python3-zmq python3-protobuf python3-numpy"   # for participants in Python
strake_packages_test="$strake_packages_python libgtest-dev libbenchmark-dev python3-h5py python3-jsonschema mandoc
  calculix-ccx"   # another finite-element program, the umpire; its tests are skipped without it
strake_packages_browser="chromium fonts-dejavu-core"   # and node with npm, where they are missing
strake_packages_paraview="paraview python3-paraview xvfb libgl1-mesa-dri"   # and a display without a screen to draw on
strake_packages_manual="mkdocs doxygen"   # pages and API reference as one HTML manual
strake_packages_package="git dpkg-dev"   # to make Debian packages
strake_packages_chroot="lintian mmdebstrap"   # to check them, and a bare Debian to install them in
strake_packages_thread="libomp-dev"   # OpenMP that tells the thread sanitizer when a loop begins and ends

# Installs the packages that are missing; says which; asks for nothing. Exit 2 with the exact line where it may not.
strake_install() {
  local missing="" package
  for package in "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing="$missing $package"
  done
  [ -n "$missing" ] || return 0
  local line="apt-get install -y --no-install-recommends$missing"
  echo "strake: installing:$missing"
  local as_root=""
  if [ "$(id -u)" -ne 0 ]; then
    if sudo -n true 2>/dev/null; then as_root="sudo -n"; else
      echo "strake: these packages are missing and installing them needs root. Run this, then try again:" >&2
      echo "  sudo $line" >&2
      exit 2
    fi
  fi
  local log
  log=$(mktemp)
  # A package list may be absent or old on a fresh machine; a half-finished earlier install is completed first.
  if ! { $as_root env DEBIAN_FRONTEND=noninteractive dpkg --configure -a &&
         $as_root apt-get update -o DPkg::Lock::Timeout=120 &&
         $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends \
           -o DPkg::Lock::Timeout=120 $missing; } >"$log" 2>&1; then
    tail -n 20 "$log" >&2
    echo "strake: the installation failed (whole log: $log). A second try goes on from here; by hand: sudo $line" >&2
    exit 2
  fi
  rm -f "$log"
}

# Prints how many compilers may run at once: one per processor, and one per 1.5 GiB of memory that is free now, which
# the largest source takes. In a container its own limit on memory counts too. strake_jobs [MEMINFO [LIMIT]]: other files.
strake_jobs() {
  local jobs free limit
  jobs=$(nproc)
  free=$(awk '/^MemAvailable:/ { print $2 }' "${1:-/proc/meminfo}")
  limit=$(cat "${2:-/sys/fs/cgroup/memory.max}" 2>/dev/null || echo max)
  if [ "$limit" != max ] && [ $((limit / 1024)) -lt "${free:-0}" ]; then free=$((limit / 1024)); fi
  free=$((${free:-0} / 1572864))
  if [ "$free" -ge 1 ] && [ "$free" -lt "$jobs" ]; then jobs=$free; elif [ "$free" -lt 1 ]; then jobs=1; fi
  echo "$jobs"
}

# Configures once and builds the named targets; silent when there is nothing to do.
strake_make() {
  if [ ! -f "$strake_build/build.ninja" ]; then
    echo "strake: configuring $strake_build"
    cmake -S "$strake_root" -B "$strake_build" -G Ninja -DCMAKE_BUILD_TYPE=Release ${STRAKE_CMAKE_OPTIONS:-} >"$strake_build.log" 2>&1 ||
      { cat "$strake_build.log" >&2; exit 70; }
    mkdir -p "$strake_build" && mv "$strake_build.log" "$strake_build/configure.log"
    grep -h 'STRAKE:' "$strake_build/configure.log" || true
  fi
  if [ "$(cd "$strake_build" && ninja -n "$@" 2>/dev/null | tail -n 1)" = "ninja: no work to do." ]; then return 0; fi
  local jobs
  jobs=$(strake_jobs)
  echo "strake: building with $jobs processes (a first build takes some minutes)"
  cmake --build "$strake_build" --parallel "$jobs" --target "$@" || exit 70
}
