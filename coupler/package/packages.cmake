# Debian packages by CPack, made by coupler/package/build.sh: four groups of the components that install.cmake names.
# Version, changelog, copyright and compressed pages are made when packaging begins (debian/*.cmake).
set(debian ${CMAKE_CURRENT_LIST_DIR}/debian)
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME strake)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "Strake developers <strake@maintainers.invalid>")   # of CITATION.cff, which gives no address
set(CPACK_STRAKE_SOURCE ${PROJECT_SOURCE_DIR})
set(CPACK_STRAKE_DEBIAN ${debian})
set(CPACK_STRAKE_LIBRARY_PLACE ${CMAKE_INSTALL_LIBDIR})
set(CPACK_PROJECT_CONFIG_FILE ${debian}/version.cmake)
set(CPACK_PRE_BUILD_SCRIPTS ${debian}/documents.cmake)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
  WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
# The libraries that the programs load, with the versions whose symbols they use.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# libprecice.so.3 is private: no other package may depend on it, and the loader does not list it.
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS OFF)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_COMPONENTS_ALL programs cases precice python participant manual)
set(CPACK_COMPONENT_PROGRAMS_GROUP runtime)
set(CPACK_COMPONENT_CASES_GROUP runtime)
set(CPACK_COMPONENT_PRECICE_GROUP runtime)
set(CPACK_COMPONENT_PARTICIPANT_GROUP development)
set(CPACK_COMPONENT_PYTHON_GROUP module)
set(CPACK_COMPONENT_MANUAL_GROUP pages)

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME strake)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION science)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS "strake-doc, openmpi-bin, calculix-ccx, ffmpeg")
set(CPACK_DEBIAN_RUNTIME_DESCRIPTION "fluid and structure solvers for hull slamming, coupled
Strake computes water entry and slamming: a particle method (MPS-LES) for
the water, finite elements, elastic particles, CalculiX or rigid bodies for
the structure, each in a process of its own, and a coupler between them.
The package holds the programs, the cases with their references, and a
private libprecice.so.3, by which solvers with a preCICE adapter take part.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libstrake-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS "cmake, g++")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "solvers of one's own for Strake: headers and libraries
What a solver in C++ is built with to take part in runs of Strake, by
find_package(strake). For solvers that call preCICE it holds headers and
configuration of Strake's libprecice in a private folder,
/usr/lib/strake/precice.")

set(CPACK_DEBIAN_MODULE_PACKAGE_NAME python3-strake)
set(CPACK_DEBIAN_MODULE_PACKAGE_SECTION python)
set(CPACK_DEBIAN_MODULE_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_MODULE_PACKAGE_CONTROL_EXTRA ${debian}/postinst ${debian}/prerm)
set(CPACK_DEBIAN_MODULE_DESCRIPTION "Strake in Python: results, runs, studies and solvers
The module strake reads runs of Strake as arrays and tables, starts runs
and studies, and makes a class with two functions a solver that takes part
in a run. Solvers that were written for the Python bindings of preCICE
take part with a private module of that name, which only runs of Strake
find.")

set(CPACK_DEBIAN_PAGES_PACKAGE_NAME strake-doc)
set(CPACK_DEBIAN_PAGES_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_PAGES_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PAGES_DESCRIPTION "manual of Strake, hull slamming by coupled solvers
Tutorial, theory, validation and file formats of Strake as HTML pages, and
the reference of its headers. `strake manual` says where they are.")
include(CPack)
