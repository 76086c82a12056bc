#pragma once

#include <precice/Version.h>

namespace strake {

/// What getVersionInformation() says: "version;revision;features".
inline constexpr char precice_version[] =
    PRECICE_VERSION "-strake;revision=strake " STRAKE_VERSION ";MPI:OFF;PETSC:OFF;PYTHON:OFF";

}  // namespace strake
