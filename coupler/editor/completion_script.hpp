#pragma once

namespace strake {

/// The functions of the completion, which read the arrays that completion.cpp writes before them.
inline constexpr const char* completion_script = R"bash(
# Words of the line up to the cursor, those that bash broke at "=" put together again, into _strake_line.
_strake_split() {
  local i word
  _strake_line=()
  for ((i = 0; i <= COMP_CWORD; i++)); do
    word=${COMP_WORDS[i]}
    if ((i > 1)) && [[ $word == "=" || ${COMP_WORDS[i - 1]} == "=" ]]; then
      _strake_line[-1]+=$word
    else
      _strake_line+=("$word")
    fi
  done
}

# Replies with the given words that begin with $1; of "key=val" only what stands behind "=".
_strake_reply() {
  local start=$1 prefix=$2
  shift 2
  local word
  for word in "$@"; do
    [[ $word == "$start"* ]] && COMPREPLY+=("$prefix$word")
  done
}

_strake_files() {
  local name
  compopt -o filenames 2>/dev/null
  while IFS= read -r name; do
    [[ -d $name || $name == *.toml || $2 == any ]] && COMPREPLY+=("$name")
  done < <(compgen -f -- "$1")
}

# Names of Strake's own cases, or of its studies, which lie beside the installed programs.
_strake_names() {
  local folder file name kind
  [[ $1 == */* ]] && return
  folder=$(type -P strake)
  folder=${folder%/bin/strake}/share/strake/cases
  for file in "$folder"/*.toml "$folder"/*/*.toml; do
    name=${file##*/}
    name=${name%.toml}
    kind=:case
    [[ $name == study_* ]] && kind=:study
    [[ -e $file && $kind == "$2" && $name == "$1"* ]] && COMPREPLY+=("$name")
  done
}

# Folders, those of runs first: they hold a run.json. Without a word the runs under runs/.
_strake_runs() {
  local name
  compopt -o filenames 2>/dev/null
  for name in "$1"*/ runs/"$1"*/; do
    name=${name%/}
    [[ -e $name/run.json && $name == "$1"* || -e $name/run.json && -z $1 ]] && COMPREPLY+=("$name")
  done
  ((${#COMPREPLY[@]})) || while IFS= read -r name; do COMPREPLY+=("$name"); done < <(compgen -d -- "$1")
}

# KEY, or KEY=VALUE with the choices of the key.
_strake_assignment() {
  local key=${1%%=*} known
  if [[ $1 == *=* ]]; then
    known=${key//\[+([0-9])\]/[0]}
    local prefix="$key="
    [[ $COMP_WORDBREAKS == *=* ]] && prefix=
    _strake_reply "${1#*=}" "$prefix" ${_strake_choices[$known]}
  else
    _strake_reply "$1" "" $_strake_keys
    COMPREPLY=("${COMPREPLY[@]/%/=}")
    compopt -o nospace 2>/dev/null
  fi
}

_strake_value() {
  case $1 in
    :case | :study)
      _strake_files "$2"
      _strake_names "$2" "$1"
      ;;
    :file) _strake_files "$2" any ;;
    :folder) compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -d -- "$2") ;;
    :run) _strake_runs "$2" ;;
    :assignment) _strake_assignment "$2" ;;
    :key) _strake_reply "$2" "" $_strake_keys ;;
    :none | "") ;;
    *) _strake_reply "$2" "" $1 ;;
  esac
}

_strake() {
  local glob=$(shopt -p extglob)
  shopt -s extglob
  COMPREPLY=()
  _strake_split
  local path=${_strake_line[0]##*/} option="" word
  local last=$((${#_strake_line[@]} - 1))
  for word in "${_strake_line[@]:1:last-1}"; do
    if [[ -n $option ]]; then
      option=
    elif [[ $word == -* ]]; then
      [[ $word != *=* && -n ${_strake_values[$path $word]} ]] && option=$word
    elif [[ " ${_strake_commands[$path]} " == *" $word "* ]]; then
      path+=" $word"
    fi
  done
  local current=${_strake_line[last]}
  if [[ -n $option ]]; then
    _strake_value "${_strake_values[$path $option]}" "$current"
  elif [[ $current == --*=* ]]; then
    _strake_value "${_strake_values[$path ${current%%=*}]}" "${current#*=}"
  elif [[ $current == -* ]]; then
    _strake_reply "$current" "" ${_strake_options[$path]}
  elif [[ -n ${_strake_commands[$path]} ]]; then
    _strake_reply "$current" "" ${_strake_commands[$path]}
  else
    _strake_value "${_strake_operands[$path]}" "$current"
  fi
  $glob
}
)bash";

}  // namespace strake
