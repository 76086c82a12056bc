# The packages' version, and what depends on it: read by cpack when packaging begins.
# 0.1.0-1 for a commit with the tag v0.1.0 and for sources without git; else 0.1.0+git20261125.811e0cd-1, which is newer than
# 0.1.0-1 and older than 0.1.1-1. Sources with changes that no commit holds are told by "+changed".
function(strake_git output)
  execute_process(COMMAND git -C ${CPACK_STRAKE_SOURCE} ${ARGN} OUTPUT_VARIABLE said OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET
    RESULT_VARIABLE failed)
  if(failed)
    set(said "")
  endif()
  set(${output} "${said}" PARENT_SCOPE)
endfunction()

set(version ${CPACK_PACKAGE_VERSION})
set(CPACK_STRAKE_DATE "")
strake_git(own rev-parse --show-prefix --is-inside-work-tree)   # one line, "true": the top of a checkout
if(own MATCHES "^[ \n]*true$")
  strake_git(commit log -1 --abbrev=12 --format=%h)
  strake_git(day log -1 --format=%cd --date=format:%Y%m%d)
  strake_git(tag tag --points-at HEAD --list v${version})
  strake_git(changes status --porcelain --untracked-files=no)
  strake_git(CPACK_STRAKE_DATE log -1 --format=%cD)
  if(commit AND (NOT tag OR changes))
    string(APPEND version "+git${day}.${commit}")
  endif()
  if(changes)
    string(APPEND version "+changed")
  endif()
endif()
if(NOT CPACK_STRAKE_DATE)
  string(TIMESTAMP CPACK_STRAKE_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)
endif()
set(CPACK_DEBIAN_PACKAGE_VERSION ${version})
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(same "(= ${version}-1)")

# What a solver is built with is at least as new as here. Libraries that must be the same are those that `strake` loads.
set(needed "strake ${same}, pkg-config")
foreach(package libeigen3-dev libfmt-dev libspdlog-dev libcli11-dev nlohmann-json3-dev libprotobuf-dev libhdf5-dev
    libtomlplusplus-dev libsodium-dev libzmq3-dev libexpat1-dev)
  execute_process(COMMAND dpkg-query -W -f "\${Version}" ${package} OUTPUT_VARIABLE here ERROR_QUIET)
  if(NOT here)
    message(FATAL_ERROR "${package}: not installed, so its version is not known; build on Debian")
  endif()
  string(REGEX REPLACE "-[^-]*$" "" here "${here}")   # without Debian's own part
  string(APPEND needed ", ${package} (>= ${here})")
endforeach()
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${needed}")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS "python3-strake ${same}")
# Messages that protoc made need Python's module of the same age; tomllib came with Python 3.11.
set(CPACK_DEBIAN_MODULE_PACKAGE_DEPENDS
  "python3 (>= 3.11), python3-numpy, python3-protobuf (>= 3.21), python3-zmq")
set(CPACK_DEBIAN_MODULE_PACKAGE_RECOMMENDS "strake ${same}, python3-h5py")
set(CPACK_DEBIAN_MODULE_PACKAGE_SUGGESTS "python3-pandas, python3-xarray, python3-matplotlib")
