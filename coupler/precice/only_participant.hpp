#pragma once

#include <precice/Participant.hpp>

#include <cstddef>
#include <exception>
#include <string>

/// The one participant of a process that calls in C or Fortran.
namespace strake {

/// Makes it. Ends the process if there is one already.
void make_only_participant(const std::string& name, const std::string& config, int rank, int size);
/// It is there, or the process ends.
::precice::Participant& only_participant();
/// Ends its part in the run; another one may be made then.
void drop_only_participant();

/// Prints an error, reports it to the coupler and ends the process. C and Fortran know no exceptions.
[[noreturn]] void end_process(const char* error);

/// Calls a function of C++ for one of C.
template <class Call>
auto for_c(Call&& call) -> decltype(call()) {
  try {
    return call();
  } catch (const std::exception& error) {
    end_process(error.what());
  }
}

/// A number of things as C and Fortran give it. Negative: the process ends.
std::size_t count(int size);

}  // namespace strake
