#!/usr/bin/env bash
# Builds the Debian packages: coupler/package/build.sh [FOLDER], by default into build-packages. Installs what is missing.
# The build is one of its own, without the instruction set of this machine (STRAKE_NATIVE=OFF). README.md says what each holds.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
out=$(realpath -m "${1:-build-packages}")
export STRAKE_BUILD="$PWD/build-packages"
export STRAKE_CMAKE_OPTIONS="-DSTRAKE_NATIVE=OFF -DSTRAKE_TESTS=OFF -DCMAKE_INSTALL_PREFIX=/usr -DCMAKE_SKIP_INSTALL_RPATH=ON
  -DSTRAKE_PYTHON_PLACE=lib/python3/dist-packages -DSTRAKE_WIDE_FOLDER=$PWD/build-packages/wide/bin"
wide="strake-fluid"
. cases/setup.sh
# shellcheck disable=SC2086
strake_install $strake_packages_build $strake_packages_manual $strake_packages_package
strake_make programs
# The solvers that gain from wider vectors (README.md) once more, for processors with AVX2 and FMA: wide_program.cpp.
(
  export STRAKE_BUILD="$strake_build/wide"
  STRAKE_CMAKE_OPTIONS="-DSTRAKE_NATIVE=OFF -DSTRAKE_TESTS=OFF -DCMAKE_SKIP_RPATH=ON -DCMAKE_CXX_FLAGS=-march=x86-64-v3"
  . cases/setup.sh
  strake_make $wide
)
/usr/bin/python3 tests/manual/build.py "$PWD" "$strake_build"
mkdir -p "$out"
rm -f "$out"/*.deb
umask 022
cpack --config "$strake_build/CPackConfig.cmake" -B "$out" >"$strake_build/cpack.log" 2>&1 ||
  { cat "$strake_build/cpack.log" >&2; exit 70; }
rm -rf "$out/_CPack_Packages"
echo "strake: packages in $out"
for package in "$out"/*.deb; do
  printf '  %6d kB  %s\n' "$(($(stat -c %s "$package") / 1000))" "$(basename "$package")"
done
