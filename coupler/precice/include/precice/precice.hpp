#pragma once

#include <precice/Exceptions.hpp>
#include <precice/Participant.hpp>
#include <precice/Tooling.hpp>
#include <precice/Types.hpp>
#include <precice/Version.h>
#include <precice/span.hpp>
