# libprecice.so.3 by Strake's text: a solver with an adapter for preCICE takes part in a run of Strake with it. It lies in a
# folder of its own, in the build tree and where it is installed: the loader and CMake find it only where somebody asks
# for it, never in place of preCICE's own.
find_package(EXPAT REQUIRED)
set(precice ${CMAKE_CURRENT_LIST_DIR})
set(STRAKE_PRECICE_VERSION 3.4.1)   # whose functions it has, as include/precice/Version.h says
# What the configuration says: for the library, and for solvers of Strake in a preCICE run.
strake_library(strake_precice_config INSTALLED TEXT SOURCES ${precice}/config/quantities.cpp
  ${precice}/config/precice_config.cpp ${precice}/config/xml_elements.cpp LINK strake_proto fmt::fmt EXPAT::EXPAT)
strake_library(strake_precice_parts INSTALLED TEXT SOURCES ${precice}/exchanged_data.cpp ${precice}/solver_mesh.cpp
  LINK strake_precice_config strake_coupling_link)
add_library(strake_precice SHARED ${precice}/participant.cpp ${precice}/participant_mesh.cpp
  ${precice}/participant_data.cpp ${precice}/tooling.cpp ${precice}/bindings_c.cpp ${precice}/bindings_fortran.cpp
  ${precice}/only_participant.cpp ${precice}/solver_run.cpp)
target_include_directories(strake_precice PRIVATE ${PROJECT_SOURCE_DIR} ${precice}/include)
target_compile_definitions(strake_precice PRIVATE STRAKE_VERSION="${PROJECT_VERSION}")
target_link_libraries(strake_precice PRIVATE strake_precice_parts strake_warnings)
set_target_properties(strake_precice PROPERTIES UNITY_BUILD ${STRAKE_UNITY} UNITY_BUILD_BATCH_SIZE 0 OUTPUT_NAME precice VERSION ${STRAKE_PRECICE_VERSION} SOVERSION 3
  LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib/strake/precice LINK_DEPENDS ${precice}/exported_symbols.map)
# Gold offers names of C++ that the map leaves out.
target_link_options(strake_precice PRIVATE $<$<BOOL:${STRAKE_GOLD}>:-fuse-ld=bfd> -Wl,--version-script=${precice}/exported_symbols.map -Wl,-Bsymbolic
  -Wl,--no-undefined)
target_compile_options(strake_precice PRIVATE -O1)
strake_reuse_headers(strake_precice strake_installed_headers)

# What an installation gets: everything in lib/strake/precice; the library is component "precice", what a solver is built with
# component "participant". The files for CMake and pkg-config find the
# library from their own place, so the folder may be moved. The build tree has the same folder.
set(STRAKE_PRECICE_PLACE lib/strake/precice)   # where programs in bin/ look for it
set(STRAKE_PRECICE_BUILT ${PROJECT_BINARY_DIR}/lib/strake/precice)
foreach(file libprecice.pc preciceConfig.cmake preciceConfigVersion.cmake)
  configure_file(${precice}/package/${file}.in ${STRAKE_PRECICE_BUILT}/${file} @ONLY)
  install(FILES ${STRAKE_PRECICE_BUILT}/${file} DESTINATION ${STRAKE_PRECICE_PLACE} COMPONENT participant)
endforeach()
file(COPY ${precice}/include DESTINATION ${STRAKE_PRECICE_BUILT} PATTERN README.md EXCLUDE)
install(DIRECTORY ${precice}/include DESTINATION ${STRAKE_PRECICE_PLACE} COMPONENT participant PATTERN README.md EXCLUDE)
install(TARGETS strake_precice LIBRARY DESTINATION ${STRAKE_PRECICE_PLACE} COMPONENT precice NAMELINK_COMPONENT participant)
