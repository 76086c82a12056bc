# What Debian asks of every package, added to the trees that cpack is about to pack: copyright, changelogs, compressed man
# pages; static libraries without what only a debugger reads.
set(names runtime:strake development:libstrake-dev module:python3-strake pages:strake-doc)
foreach(pair ${names})
  string(REPLACE ":" ";" pair ${pair})
  list(GET pair 0 group)
  list(GET pair 1 package)
  set(tree ${CPACK_TEMPORARY_DIRECTORY}/${group}/usr)
  set(about ${tree}/share/doc/${package})
  file(MAKE_DIRECTORY ${about})
  configure_file(${CPACK_STRAKE_DEBIAN}/copyright ${about}/copyright COPYONLY)
  file(WRITE ${about}/changelog.Debian "strake (${CPACK_DEBIAN_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium

  * Packages made from the sources of Strake by coupler/package/build.sh.

 -- ${CPACK_DEBIAN_PACKAGE_MAINTAINER}  ${CPACK_STRAKE_DATE}
")
  configure_file(${CPACK_STRAKE_SOURCE}/CHANGELOG.md ${about}/changelog COPYONLY)
  file(MAKE_DIRECTORY ${tree}/share/lintian/overrides)
  configure_file(${CPACK_STRAKE_DEBIAN}/lintian-overrides ${tree}/share/lintian/overrides/${package} COPYONLY)
  file(GLOB pages ${about}/changelog ${about}/changelog.Debian ${tree}/share/man/man1/*.1)
  execute_process(COMMAND gzip -9n ${pages} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
file(GLOB archives ${CPACK_TEMPORARY_DIRECTORY}/development/usr/${CPACK_STRAKE_LIBRARY_PLACE}/*.a)
execute_process(COMMAND strip --strip-debug --remove-section=.comment --remove-section=.note --enable-deterministic-archives
  ${archives} COMMAND_ERROR_IS_FATAL ANY)
file(GLOB wide ${CPACK_TEMPORARY_DIRECTORY}/runtime/usr/lib/strake/x86-64-v3/*)
if(wide)
  execute_process(COMMAND strip ${wide} COMMAND_ERROR_IS_FATAL ANY)
endif()
