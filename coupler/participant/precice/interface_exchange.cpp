#include "coupler/participant/precice/interface_exchange.hpp"

#include "proto/error.hpp"

#include <fmt/format.h>

#include <utility>

namespace strake {
namespace {

using Eigen::Index;

std::string unit_of(const std::string& quantity) {
  if (quantity == "force") return "N";
  if (quantity == "displacement") return "m";
  return quantity == "velocity" ? "m/s" : "1";
}

/// The numbers of the vertices of all faces, one face after the other.
std::vector<int> corners_of(const Eigen::MatrixXi& faces, const std::vector<int>& ids) {
  std::vector<int> corners;
  for (Index f = 0; f < faces.cols(); ++f)
    for (Index k = 0; k < faces.rows(); ++k) corners.push_back(ids[static_cast<std::size_t>(faces(k, f))]);
  return corners;
}

}  // namespace

InterfaceExchange::InterfaceExchange(const PreciceLibrary& library, const OwnPart& part,
                                     const InterfaceMesh& mesh)
    : library_(library), part_(part), ids_(static_cast<std::size_t>(mesh.position.cols())) {
  if (ids_.empty())
    throw Error(ExitCode::case_file, fmt::format("mesh \"{}\"", part.mesh),
                "would have no points: no water meets the body",
                "is the body inside the tank? Has it faces? strake-structure-… CASE --interface prints them");
  const Eigen::MatrixXd position = mesh.position.topRows(part.dimension);
  const char* name = part.mesh.c_str();
  library.set_vertices(name, static_cast<int>(ids_.size()), position.data(), ids_.data());
  if (mesh.faces.cols() == 0 || library.needs_faces(name) == 0) return;
  const std::vector<int> corners = corners_of(mesh.faces, ids_);
  const auto set = part.dimension == 2 ? library.set_edges : library.set_triangles;
  set(name, static_cast<int>(mesh.faces.cols()), corners.data());
}

std::vector<Field> InterfaceExchange::read(double from_now) const {
  std::vector<Field> fields;
  const auto n = static_cast<Index>(ids_.size());
  for (const OwnPart::Data& data : part_.reads) {
    Eigen::MatrixXd value(data.components, n);
    library_.read(part_.mesh.c_str(), data.name.c_str(), static_cast<int>(n), ids_.data(), from_now,
                  value.data());
    if (data.components == 2) {
      value.conservativeResize(3, n);
      value.row(2).setZero();
    }
    fields.push_back({data.quantity, unit_of(data.quantity), data.quantity == "force", std::move(value)});
  }
  return fields;
}

void InterfaceExchange::write(const std::vector<Field>& fields, const std::string& when) const {
  const auto n = static_cast<Index>(ids_.size());
  for (const OwnPart::Data& data : part_.writes) {
    const Field* field = find(fields, data.quantity);
    if (!field || field->value.cols() != n || field->value.rows() < data.components)
      throw Error(
          ExitCode::solver_fault, when,
          fmt::format("the solver gives no {} there, which data \"{}\" stands for", data.quantity, data.name),
          fmt::format("leave \"{}\" out of the configuration", data.name));
    const Eigen::MatrixXd value = field->value.topRows(data.components);
    if (!all_finite(value))
      throw Error(ExitCode::solver_fault, when, fmt::format("the solver's {} is not finite", data.quantity),
                  "a smaller window or step may help");
    library_.write(part_.mesh.c_str(), data.name.c_str(), static_cast<int>(n), ids_.data(), value.data());
  }
}

}  // namespace strake
