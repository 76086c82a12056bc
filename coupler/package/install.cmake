# What `cmake --install` leaves, by component; packages.cmake makes Debian packages of them.
#   programs     the programs, which find each other in one folder, their man pages and completion
#   cases        Strake's own cases, which the programs find by name; without python_spring
#   precice      libprecice.so.3 in its private folder (coupler/precice/library.cmake)
#   python       the package `strake` and the messages, python_spring; apart from them the module `precice`
#   participant  find_package(strake), then target_link_libraries(solver strake::participant); headers of libprecice
#   manual       the pages
include(CMakePackageConfigHelpers)
get_property(programs GLOBAL PROPERTY STRAKE_PROGRAMS)
install(TARGETS ${programs} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
set(STRAKE_WIDE_FOLDER "" CACHE PATH "programs compiled for x86-64-v3, which are taken where the processor can execute them")
if(STRAKE_WIDE_FOLDER)
  install(DIRECTORY ${STRAKE_WIDE_FOLDER}/ DESTINATION lib/strake/x86-64-v3 COMPONENT programs USE_SOURCE_PERMISSIONS
    FILES_MATCHING PATTERN "strake-*")
endif()
# Man pages and completion come from the programs' own declarations, so they are written by `strake` when it is installed.
set(pages ${PROJECT_BINARY_DIR}/pages)
install(CODE "execute_process(COMMAND \"${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/strake\" explain --man \"${pages}/man1\"
    COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
  file(MAKE_DIRECTORY \"${pages}/completions\")
  execute_process(COMMAND \"${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/strake\" explain --completion bash
    COMMAND_ERROR_IS_FATAL ANY OUTPUT_FILE \"${pages}/completions/strake\")" COMPONENT programs)
install(DIRECTORY ${pages}/man1/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT programs FILES_MATCHING PATTERN "*.1")
install(FILES ${pages}/completions/strake DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT programs)

set(data ${CMAKE_INSTALL_DATADIR}/strake)
set(cases ${PROJECT_SOURCE_DIR}/cases)
install(DIRECTORY ${cases}/ DESTINATION ${data}/cases COMPONENT cases
  FILES_MATCHING PATTERN "*.toml" PATTERN "*.msh" PATTERN "*.csv" PATTERN pictures EXCLUDE PATTERN paraview EXCLUDE
  PATTERN python_spring EXCLUDE)

# The package `strake` may lie where Python looks by itself (STRAKE_PYTHON_PLACE). The messages and `precice` never do.
set(STRAKE_PYTHON_PLACE ${data}/python CACHE STRING "folder of the Python package strake, below the prefix")
install(FILES ${PROJECT_BINARY_DIR}/python/coupling_pb2.py DESTINATION ${data}/python COMPONENT python)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/coupler/python/strake
  DESTINATION ${STRAKE_PYTHON_PLACE} COMPONENT python FILES_MATCHING PATTERN "*.py" PATTERN __pycache__ EXCLUDE)
install(FILES ${PROJECT_BINARY_DIR}/python/strake/version.py DESTINATION ${STRAKE_PYTHON_PLACE}/strake COMPONENT python)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/coupler/python/precice
  DESTINATION ${data}/python_precice COMPONENT python FILES_MATCHING PATTERN "*.py" PATTERN __pycache__ EXCLUDE)

# The case whose solver is written in Python goes with what it needs.
install(FILES ${cases}/python_spring/python_spring.toml DESTINATION ${data}/cases/python_spring COMPONENT python)
install(PROGRAMS ${cases}/python_spring/spring.py DESTINATION ${data}/cases/python_spring COMPONENT python)

install(DIRECTORY ${PROJECT_BINARY_DIR}/manual/   # where tests/run.sh --manual has made it
  DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/strake/html COMPONENT manual OPTIONAL PATTERN "sitemap.xml*" EXCLUDE)

# A participant's own headers: Eigen and the standard library, nothing else.
set(headers coupler/participant/participant_main.hpp coupler/participant/serve.hpp proto/archive_source.hpp proto/box.hpp proto/case/case_file.hpp proto/case/key_info.hpp proto/case/case_keys.hpp proto/error.hpp
  proto/files/frame_writer.hpp proto/files/file_part.hpp proto/interface.hpp proto/interpolation.hpp proto/participant.hpp proto/probe.hpp proto/files/result_file.hpp
  proto/case/foreign_keys.hpp proto/case/size_limit.hpp proto/case/window_choice.hpp proto/values.hpp proto/files/vector_participant.hpp)
foreach(header ${headers})
  cmake_path(GET header PARENT_PATH folder)
  install(FILES ${PROJECT_SOURCE_DIR}/${header}
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/strake/${folder} COMPONENT participant)
endforeach()

install(FILES ${PROJECT_SOURCE_DIR}/proto/coupling.proto DESTINATION ${data}/proto COMPONENT participant)

set(parts proto proto_files coupling_pb proto_wire coupling_link precice_config participant_main)
foreach(part ${parts})
  set_target_properties(strake_${part} PROPERTIES EXPORT_NAME ${part} POSITION_INDEPENDENT_CODE ON)
endforeach()
set_target_properties(strake_participant_main PROPERTIES EXPORT_NAME participant)
list(TRANSFORM parts PREPEND strake_)
# Both sides of the library must align Eigen's memory alike: what one allocates the other frees.
target_compile_definitions(strake_proto INTERFACE
  "$<INSTALL_INTERFACE:EIGEN_MAX_ALIGN_BYTES=64;EIGEN_DONT_PARALLELIZE>")
target_compile_features(strake_proto INTERFACE cxx_std_20)
install(TARGETS ${parts} EXPORT strake-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT participant
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/strake)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/strake)
install(EXPORT strake-targets NAMESPACE strake:: DESTINATION ${package} COMPONENT participant)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/strake-config.cmake.in
  ${PROJECT_BINARY_DIR}/strake-config.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/strake-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/strake-config.cmake ${PROJECT_BINARY_DIR}/strake-config-version.cmake
  DESTINATION ${package} COMPONENT participant)
if(PROJECT_IS_TOP_LEVEL)
  include(${CMAKE_CURRENT_LIST_DIR}/packages.cmake)
endif()
