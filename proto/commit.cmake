# Writes the header that names the commit of the sources and its day: cmake -DSOURCE=… -DHEADER=… -P commit.cmake
# Sources inside a checkout of something else have no commit of their own.
execute_process(COMMAND git -C ${SOURCE} rev-parse --show-cdup
  OUTPUT_VARIABLE above OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
execute_process(COMMAND git -C ${SOURCE} log -1 --abbrev=12 "--format=%h;%cs"
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(failed OR NOT above STREQUAL "" OR NOT commit MATCHES "^[0-9a-f]+;[0-9-]+$")
  set(commit "unknown;")
endif()
string(REPLACE ";" "\"\n#define STRAKE_COMMIT_DATE \"" commit "${commit}")
file(WRITE ${HEADER} "#define STRAKE_COMMIT \"${commit}\"\n")
