#!/usr/bin/env bash
# Installs, builds and runs every test: tests/run.sh [--sanitize [thread]] [options of ctest, such as -L unit or -R name]
# --browser: the page of `strake watch --web` in Chromium, its types, its lint, and whether its bundle is what its sources
#   build (tests/browser); pictures of it are left in build/browser.
# --sanitize: a build of its own with the address and undefined-behaviour sanitizers; unit and method tests.
# --sanitize thread: the same with the thread sanitizer; the tests of proto/ and coupler/, and those of messages and processes.
#   GCC's own OpenMP library does not tell the sanitizer where threads wait for one another, and every loop would look
#   like a race. LLVM's takes its place there and does, by its tool archer.
# --paraview: what runs write, opened in ParaView (installs it, 1 GB); pictures in build/paraview. A run of all does not do it.
# --manual: all pages and the API reference as one HTML manual in build/manual, with strict links; builds no program.
# --packages: the Debian packages (coupler/package), built, checked by lintian, installed in a bare Debian, used, removed. A run of
#   all does not do it: it needs root, and 1.5 GB for the bare Debian. Options after it go to tests/packages/install.py (--keep).
# The fuzz targets need clang, and are run by hand, as long as one likes:
#   cmake -S . -B build-fuzz -G Ninja -DSTRAKE_FUZZ=ON -DCMAKE_CXX_COMPILER=clang++ && cmake --build build-fuzz
#   mkdir -p build-fuzz/wire && build-fuzz/bin/wire_fuzz -malloc_limit_mb=64 build-fuzz/wire tests/fuzz/corpus/wire   (and case, mesh)
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
cd "$here/.."
. cases/setup.sh
chosen=()
targets=(all)
if [ "${1:-}" = "--manual" ]; then
  # shellcheck disable=SC2086
  strake_install $strake_packages_manual
  exec /usr/bin/python3 tests/manual/build.py "$PWD" "$strake_build"
elif [ "${1:-}" = "--packages" ]; then
  shift
  # shellcheck disable=SC2086
  strake_install $strake_packages_chroot
  coupler/package/build.sh
  exec /usr/bin/python3 -B tests/packages/install.py "$PWD" "$PWD/build-packages" "$@"
elif [ "${1:-}" = "--paraview" ]; then
  # shellcheck disable=SC2086
  strake_install $strake_packages_build $strake_packages_test $strake_packages_paraview
  strake_make programs
  exec /usr/bin/python3 tests/paraview/open_results.py "$PWD" "$strake_build/bin" "$strake_build/paraview"
elif [ "${1:-}" = "--sanitize" ] && [ "${2:-}" = "thread" ]; then
  shift 2
  strake_build="$PWD/build-thread"
  # shellcheck disable=SC2086
  strake_install $strake_packages_thread
  llvm=$(dirname "$(find /usr/lib/llvm-*/lib -name libarcher.so | sort -V | tail -n 1)")
  export STRAKE_CMAKE_OPTIONS="-DSTRAKE_SANITIZE=thread -DSTRAKE_NATIVE=OFF -DSTRAKE_FEM=OFF -DOpenMP_gomp_LIBRARY=$llvm/libgomp.so"
  export OMP_TOOL_LIBRARIES="$llvm/libarcher.so"
  export TSAN_OPTIONS="suppressions=$PWD/tests/thread_sanitizer.supp halt_on_error=1 second_deadlock_stack=1"
  targets=(threads)
  chosen=(-E '_NOT_BUILT|^(system|repo|fuzz)\.|^proto.golden$')
elif [ "${1:-}" = "--sanitize" ]; then
  shift
  strake_build="$PWD/build-sanitize"
  export STRAKE_CMAKE_OPTIONS="-DSTRAKE_SANITIZE=ON -DSTRAKE_NATIVE=OFF"
  # Whole call stacks: a leak is told by the library that made it.
  export ASAN_OPTIONS=detect_leaks=1:halt_on_error=1:fast_unwind_on_malloc=0
  export UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1 LSAN_OPTIONS="suppressions=$PWD/tests/leak_sanitizer.supp"
  chosen=(-L 'unit|method')
fi
if [ "${1:-}" = "--browser" ]; then
  # shellcheck disable=SC2086
  strake_install $strake_packages_build $strake_packages_test $strake_packages_browser
  command -v node >/dev/null && command -v npm >/dev/null || strake_install nodejs npm
  strake_make programs
  export STRAKE_BIN="$strake_build/bin" STRAKE_BROWSER_OUTPUT="$strake_build/browser"
  export OMPI_MCA_ess_singleton_isolated=1 npm_config_omit_lockfile_registry_resolved=true
  cd tests/browser
  npm ci --ignore-scripts --no-audit --no-fund
  npm run types
  npm run lint
  npm run check-bundle
  exec node --test-reporter=spec page.test.mjs
fi
# shellcheck disable=SC2086
strake_install $strake_packages_build $strake_packages_test
strake_make "${targets[@]}"
export OMP_WAIT_POLICY=passive OPENBLAS_NUM_THREADS=1 OMPI_MCA_ess_singleton_isolated=1
echo "strake: not run here: the page of strake watch in a browser (tests/run.sh --browser), results in ParaView (tests/run.sh --paraview), the Debian packages (tests/run.sh --packages)"
ctest --test-dir "$strake_build" --output-on-failure --no-tests=error --parallel 2 "${chosen[@]}" "$@"
