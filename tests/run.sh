#!/usr/bin/env bash
# Installs, builds and runs every test: tests/run.sh [--sanitize] [options of ctest, such as -L unit or -R name]
# --sanitize: a build of its own with the address and undefined-behaviour sanitizers; unit and method tests.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
cd "$here/.."
labels=()
if [ "${1:-}" = "--sanitize" ]; then
  shift
  export STRAKE_BUILD="$PWD/build-sanitize" STRAKE_CMAKE_OPTIONS="-DSTRAKE_SANITIZE=ON -DSTRAKE_NATIVE=OFF"
  export ASAN_OPTIONS=detect_leaks=1:halt_on_error=1 UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
  labels=(-L 'unit|method')
fi
. cases/setup.sh
# shellcheck disable=SC2086
strake_install $strake_packages_build $strake_packages_test
strake_make all
export OMP_WAIT_POLICY=passive OPENBLAS_NUM_THREADS=1 OMPI_MCA_ess_singleton_isolated=1
ctest --test-dir "$strake_build" --output-on-failure --no-tests=error --parallel 2 "${labels[@]}" "$@"
