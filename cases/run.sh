#!/usr/bin/env bash
# Runs a case by name: cases/run.sh plate_entry [options of `strake run`]
# Installs what is missing, builds what is out of date, and runs into runs/<case>, runs/<case>-2, …
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

names() { for f in "$here"/*.toml; do printf ' %s' "$(basename "$f" .toml)"; done; }
if [ $# -lt 1 ] || [ "$1" = "-h" ] || [ "$1" = "--help" ]; then
  echo "usage: cases/run.sh CASE [options of \`strake run\`]"
  echo "cases:$(names)"
  [ $# -ge 1 ] && exit 0 || exit 2
fi
case_name=$(basename "$1" .toml)
shift
if [ ! -f "$here/$case_name.toml" ]; then
  echo "cases/run.sh: there is no case \"$case_name\"" >&2
  echo "  fix: one of$(names)" >&2
  exit 2
fi
. "$here/setup.sh"
# shellcheck disable=SC2086
strake_install $strake_packages_build
strake_make programs
exec "$strake_build/bin/strake" run "$here/$case_name.toml" --first-free-tag "$@"
