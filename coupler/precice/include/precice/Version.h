#pragma once

/* The version of preCICE whose functions this library offers. */
#define PRECICE_VERSION_MAJOR 3
#define PRECICE_VERSION_MINOR 4
#define PRECICE_VERSION_PATCH 1
#define PRECICE_VERSION "3.4.1"

/* True if that version is at least major.minor.patch. */
#define PRECICE_VERSION_GREATER_EQUAL(major, minor, patch)                                   \
  (PRECICE_VERSION_MAJOR * 1000000 + PRECICE_VERSION_MINOR * 1000 + PRECICE_VERSION_PATCH >= \
   (major)*1000000 + (minor)*1000 + (patch))
