#!/usr/bin/env bash
# Runs a case by name: cases/run.sh plate_entry [options of `strake run`]; or a study: cases/run.sh study_plate [options of `strake study`]
# Installs what is missing, builds what is out of date, and runs into runs/<case>, runs/<case>-2, …; a study goes on where it stopped
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

names() { for f in "$here"/*.toml "$here"/*/*.toml; do printf ' %s' "$(basename "$f" .toml)"; done; }
if [ $# -lt 1 ] || [ "$1" = "-h" ] || [ "$1" = "--help" ]; then
  echo "usage: cases/run.sh CASE [options of \`strake run\`], or STUDY [options of \`strake study\`]"
  echo "cases:$(names)"
  [ $# -ge 1 ] && exit 0 || exit 2
fi
case_name=$(basename "$1" .toml)
shift
case_file=$here/$case_name.toml
[ -f "$case_file" ] || case_file=$here/$case_name/$case_name.toml   # with a program of its own beside it
if [ ! -f "$case_file" ]; then
  echo "cases/run.sh: there is no case \"$case_name\"" >&2
  echo "  fix: one of$(names)" >&2
  exit 2
fi
. "$here/setup.sh"
# shellcheck disable=SC2086
strake_install $strake_packages_build
# shellcheck disable=SC2086
[ -z "$(find "$(dirname "$case_file")" -maxdepth 1 -name '*.py')" ] || strake_install $strake_packages_python
if grep -q 'structure.solver=ccx' "$case_file"; then strake_install calculix-ccx; fi
strake_make programs
if grep -q '^\[\[axis\]\]' "$case_file"; then
  exec "$strake_build/bin/strake" study "$case_file" "$@"
fi
exec "$strake_build/bin/strake" run "$case_file" --first-free-tag "$@"
