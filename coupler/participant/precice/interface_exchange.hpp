#pragma once

#include "coupler/participant/precice/c_library.hpp"
#include "coupler/participant/precice/own_part.hpp"
#include "proto/interface.hpp"

#include <vector>

namespace strake {

/// A solver's interface in preCICE: its points, its faces, and fields on the points.
class InterfaceExchange {
 public:
  /// Sets the points, and the faces where the library asks for them. To be called before `initialize`.
  /// Error(case_file) for a mesh without points.
  InterfaceExchange(const PreciceLibrary&, const OwnPart&, const InterfaceMesh&);

  /// The partner's fields at a time of the window, `from_now` from now [s], with Strake's names and three
  /// components (z = 0 in two dimensions).
  std::vector<Field> read(double from_now) const;
  /// Writes each data of the part from the field of its quantity. Error(solver_fault) if a field is missing
  /// or a value is not finite; `when` says of which window.
  void write(const std::vector<Field>&, const std::string& when) const;

 private:
  const PreciceLibrary& library_;
  const OwnPart& part_;
  std::vector<int> ids_;
};

}  // namespace strake
