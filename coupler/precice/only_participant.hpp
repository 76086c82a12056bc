#pragma once

#include <precice/Participant.hpp>

#include <cstddef>
#include <exception>
#include <string>

/// The one participant of a process that calls in C or Fortran.
namespace strake {

/// Makes it. An error if there is one already.
void make_only_participant(const std::string& name, const std::string& config, int rank, int size);
/// It is there, or that is an error.
::precice::Participant& only_participant();
/// Ends its part in the run; another one may be made then.
void drop_only_participant();

/// Hands an error to `strake_precice_on_error`'s function. Without one it prints the error, reports it to the
/// coupler and ends the process: C and Fortran know no exceptions.
void tell_error(const char* error);

/// Calls a function of C++ for one of C. After an error that was handed on it returns 0.
template <class Call>
auto for_c(Call&& call) -> decltype(call()) {
  try {
    return call();
  } catch (const std::exception& error) {
    tell_error(error.what());
    return decltype(call())();
  }
}

/// A number of things as C and Fortran give it. An error if it is negative.
std::size_t count(int size);

}  // namespace strake

extern "C" {
/// For a language that has exceptions (coupler/python/precice): the function gets the text of each error, in
/// the call that has it. Null: the process ends again.
__attribute__((visibility("default"))) void strake_precice_on_error(void (*take)(const char* error));
/// Ends the part of the only participant in the run, as its destructor does. Nothing where there is none.
__attribute__((visibility("default"))) void strake_precice_drop();
}
