# Writes the header that names the commit of the sources: cmake -DSOURCE=… -DHEADER=… -P commit.cmake
execute_process(COMMAND git -C ${SOURCE} rev-parse --short=12 HEAD
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed OR NOT commit)
  set(commit "unknown")
endif()
file(WRITE ${HEADER} "#define STRAKE_COMMIT \"${commit}\"\n")
