#pragma once

#include <precice/export.h>

#include <iosfwd>
#include <string>

namespace precice {

namespace tooling {

enum struct ConfigReferenceType { XML = 0, DTD = 1, MD = 2 };

/// Prints what this library reads of a configuration file; the same text for every type.
PRECICE_API void printConfigReference(std::ostream& out, ConfigReferenceType type);

/// Reads a configuration file as that participant would. Throws precice::Error for what it would refuse.
PRECICE_API void checkConfiguration(const std::string& file, const std::string& participant, int size);

}  // namespace tooling

/// "version;revision;features"
PRECICE_API std::string getVersionInformation();

}  // namespace precice
