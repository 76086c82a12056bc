#pragma once

#include "proto/coupling.pb.h"
#include "proto/wire/wire.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

/// The checks of a message and the raw arrays behind its header, for wire.cpp alone.
namespace strake::wire {

// ---- rules of both sides

/// Checks one message; errors name its sender.
struct Rules {
  const std::string& who;
  const char* message;

  [[noreturn]] void broken(const std::string& what) const {
    throw Error(ExitCode::participant_lost, who, fmt::format("its {} message {}", message, what),
                fmt::format("both sides must speak protocol {} of proto/coupling.proto", protocol));
  }
  template <class Matrix>
  void finite(const Matrix& value, const std::string& name, const std::string& unit) const {
    if (all_finite(value)) return;
    for (Eigen::Index j = 0; j < value.cols(); ++j)
      for (Eigen::Index i = 0; i < value.rows(); ++i)
        if (!std::isfinite(value(i, j)))
          throw Error(ExitCode::solver_fault, who,
                      fmt::format("{} is not finite: {} {} at point {} of {}, component {}", name,
                                  value(i, j), unit, j, value.cols(), i));
  }
  void finite(double value, const char* name) const {
    if (!std::isfinite(value))
      throw Error(ExitCode::solver_fault, who,
                  fmt::format("{} is not finite ({}) in {}", name, value, message));
  }
  void limit(double dt_limit) const {
    if (!(dt_limit > 0))
      throw Error(ExitCode::solver_fault, who,
                  fmt::format("dt_limit is {} s in {}, expected > 0", dt_limit, message));
  }
  /// A name, which will stand in messages, logs and column heads; a stranger may have chosen it.
  void label(const std::string& text, const char* what, std::size_t longest = 200 /* bytes */) const {
    if (text.size() > longest)
      broken(fmt::format("gives a {} of {} bytes, expected at most {}", what, text.size(), longest));
    for (const char letter : text)
      if (const auto c = static_cast<unsigned char>(letter); c < 0x20 || c == 0x7f)
        broken(fmt::format("gives a {} that holds the character {:#04x}", what, c));
  }
  /// The columns of history.csv are identified by their names.
  void columns(const std::vector<Column>& all) const {
    std::set<std::string> names;
    for (const Column& column : all) {
      label(column.name, "column");
      label(column.unit, "column");
      if (!names.insert(column.name).second)
        broken(fmt::format("gives the column {} twice, expected names that differ", column.name));
    }
  }
  void field(const Field& f) const {
    label(f.quantity, "quantity");
    label(f.unit, "unit");
    if (f.quantity.empty()) broken("holds a field without a quantity");
    if (f.unit.empty()) broken(fmt::format("gives no unit for {} (\"1\" for a pure number)", f.quantity));
    if (f.value.rows() == 0) broken(fmt::format("gives no components for {}", f.quantity));
    if (!f.value.known_finite()) finite(f.value, f.quantity, f.unit);
  }
  void mesh(const InterfaceMesh& m) const {
    label(m.name, "mesh name");
    if (m.dimension != 2 && m.dimension != 3)
      broken(fmt::format("has a mesh of dimension {}, expected 2 or 3", m.dimension));
    finite(m.position, "mesh position", "m");
    finite(m.mass, "mesh mass", "kg");
    const Eigen::Index n = m.position.cols();
    if (m.mass.size() != 0 && m.mass.size() != n)
      broken(fmt::format("has {} masses for {} points", m.mass.size(), n));
    meshes(m);
    if (m.faces.cols() == 0) return;
    if (m.faces.rows() != m.dimension)
      broken(fmt::format("has faces of {} points, expected {}", m.faces.rows(), m.dimension));
    if (m.faces.minCoeff() < 0 || m.faces.maxCoeff() >= n)
      broken(fmt::format("has a face with point {}, expected 0 to {}",
                         m.faces.minCoeff() < 0 ? m.faces.minCoeff() : m.faces.maxCoeff(), n - 1));
  }
  /// Several meshes in one: names that differ, each with points, one after the other, faces on its own
  /// points.
  void meshes(const InterfaceMesh& m) const {
    std::set<std::string> names;
    for (std::size_t k = 0; k < m.meshes.size(); ++k) {
      const MeshPart& part = m.meshes[k];
      label(part.name, "mesh name");
      if (part.name.empty() || !names.insert(part.name).second)
        broken(fmt::format("names the mesh \"{}\" twice or without a name", part.name));
      const bool last = k + 1 == m.meshes.size();
      const Eigen::Index end = last ? m.position.cols() : m.meshes[k + 1].first_point,
                         end_face = last ? m.faces.cols() : m.meshes[k + 1].first_face;
      const bool in_order = (k > 0 || (part.first_point == 0 && part.first_face == 0)) &&
                            part.first_point >= 0 && part.first_point < end && end <= m.position.cols() &&
                            part.first_face >= 0 && part.first_face <= end_face && end_face <= m.faces.cols();
      if (!in_order)
        broken(fmt::format("gives no place for the mesh {}, expected one after the other", part.name));
      const auto own = m.faces.middleCols(part.first_face, end_face - part.first_face);
      if (own.size() > 0 && (own.minCoeff() < part.first_point || own.maxCoeff() >= end))
        broken(fmt::format("has a face of the mesh {} on a point of another mesh", part.name));
    }
  }
  /// Each field that is sent has one of the meshes, where there are several.
  void places(const InterfaceMesh& mesh, const Description& d) const {
    const auto known = [&](const std::string& name) {
      for (const MeshPart& part : mesh.meshes)
        if (part.name == name) return true;
      return false;
    };
    for (const auto* mesh_of : {&d.sent_on, &d.taken_on})
      for (const auto& [quantity, name] : *mesh_of)
        if (!known(name)) broken(fmt::format("has {} on the mesh \"{}\", which it lacks", quantity, name));
    if (mesh.meshes.empty()) return;
    for (const Field& field : d.initial)
      if (!d.sent_on.contains(field.quantity))
        broken(fmt::format("joins {} meshes and does not say on which one {} is sent", mesh.meshes.size(),
                           field.quantity));
  }
};

// ---- values to bytes

/// Collects the parts; the arrays stay where they are, kept alive by `owner`.
class Writer {
 public:
  Writer(Rules rules, std::shared_ptr<const void> owner)
      : rules_(rules), owner_(std::move(owner)), parts_(1) {}

  const Rules& rules() const { return rules_; }
  void mesh(const InterfaceMesh& from, pb::Mesh& to) {
    rules_.mesh(from);
    to.set_name(from.name);
    to.set_dimension(static_cast<std::uint32_t>(from.dimension));
    to.set_n_points(static_cast<std::uint64_t>(from.position.cols()));
    to.set_n_faces(static_cast<std::uint64_t>(from.faces.cols()));
    to.set_has_mass(from.mass.size() != 0);
    for (const MeshPart& part : from.meshes) {
      pb::MeshPart& one = *to.add_meshes();
      one.set_name(part.name);
      one.set_first_point(static_cast<std::uint64_t>(part.first_point));
      one.set_first_face(static_cast<std::uint64_t>(part.first_face));
    }
    array(from.position);
    if (from.faces.cols() != 0) array(from.faces);
    if (from.mass.size() != 0) array(from.mass);
  }
  template <class Repeated>
  void fields(const std::vector<Field>& from, Repeated& to) {
    for (const Field& f : from) {
      rules_.field(f);
      pb::Field& header = *to.Add();
      header.set_quantity(f.quantity);
      header.set_unit(f.unit);
      header.set_components(static_cast<std::uint32_t>(f.value.rows()));
      header.set_conservative(f.conservative);
      header.set_n_points(static_cast<std::uint64_t>(f.value.cols()));
      array(f.value);
    }
  }
  template <class Header>
  Parts finish(const Header& header) {
    auto text = std::make_shared<std::string>();
    if (!header.SerializeToString(text.get())) rules_.broken("cannot be written");
    parts_.front() = {std::as_bytes(std::span(*text)), text};
    return std::move(parts_);
  }

 private:
  template <class Matrix>
  void array(const Matrix& m) {
    const std::span numbers(m.data(), static_cast<std::size_t>(m.size()));
    parts_.push_back({std::as_bytes(numbers), owner_});
  }

  Rules rules_;
  std::shared_ptr<const void> owner_;
  Parts parts_;
};

// ---- bytes to values

/// Takes the arrays in the announced order. An announced count is compared with the bytes that came before it
/// is used.
class Reader {
 public:
  Reader(Rules rules, const Parts& parts) : rules_(rules), parts_(parts) {}

  const Rules& rules() const { return rules_; }
  InterfaceMesh mesh(const pb::Mesh& from) {
    InterfaceMesh to;
    to.name = from.name();
    if (from.dimension() != 2 && from.dimension() != 3)
      rules_.broken(fmt::format("has a mesh of dimension {}, expected 2 or 3", from.dimension()));
    to.dimension = static_cast<int>(from.dimension());
    array(to.position, 3, from.n_points(), "mesh position");
    if (from.n_faces() != 0) array(to.faces, from.dimension(), from.n_faces(), "mesh faces");
    if (from.has_mass()) array(to.mass, 1, from.n_points(), "mesh mass");
    for (const pb::MeshPart& part : from.meshes())
      to.meshes.push_back({part.name(), static_cast<Eigen::Index>(part.first_point()),
                           static_cast<Eigen::Index>(part.first_face())});
    rules_.mesh(to);
    return to;
  }
  template <class Repeated>
  std::vector<Field> fields(const Repeated& from) {
    std::vector<Field> to;
    for (const pb::Field& header : from) {
      Field f{header.quantity(), header.unit(), header.conservative(), {}};
      rules_.label(f.quantity, "quantity");
      if (header.components() == 0) rules_.broken(fmt::format("gives no components for {}", f.quantity));
      f.value = values(header.components(), header.n_points(), f.quantity);
      f.value.check_finite();
      rules_.field(f);
      to.push_back(std::move(f));
    }
    return to;
  }
  /// Every part must have been announced.
  void end() const {
    if (next_ != parts_.size())
      rules_.broken(fmt::format("has {} parts, expected {}: a header and its arrays", parts_.size(), next_));
  }

 private:
  /// The next part, which must have that many numbers.
  template <class Number>
  const Part& part(std::uint64_t rows, std::uint64_t columns, const std::string& name) {
    if (next_ == parts_.size())
      rules_.broken(fmt::format("has {} parts; the one for {} is missing", parts_.size(), name));
    const Part& part = parts_[next_++];
    const std::size_t size = part.bytes.size();
    const std::uint64_t column_bytes = rows * sizeof(Number);  // rows is 32 bits wide: no overflow
    if (size % column_bytes != 0 || size / column_bytes != columns)
      rules_.broken(fmt::format("has {} bytes for {}, expected {} x {} numbers of {} bytes", size, name, rows,
                                columns, sizeof(Number)));
    return part;
  }
  template <class Matrix>
  void array(Matrix& to, std::uint64_t rows, std::uint64_t columns, const std::string& name) {
    const auto bytes = part<typename Matrix::Scalar>(rows, columns, name).bytes;
    if constexpr (Matrix::ColsAtCompileTime == 1)
      to.resize(static_cast<Eigen::Index>(columns));
    else
      to.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
    if (!bytes.empty()) std::memcpy(to.data(), bytes.data(), bytes.size());
  }
  /// Many numbers stay where they came; few are copied, out of what may be a part of a larger message.
  Values values(std::uint64_t rows, std::uint64_t columns, const std::string& name) {
    constexpr std::size_t many = 32768;  // [bytes]
    const Part& from = part<double>(rows, columns, name);
    const auto r = static_cast<Eigen::Index>(rows), c = static_cast<Eigen::Index>(columns);
    const bool aligned = reinterpret_cast<std::uintptr_t>(from.bytes.data()) % alignof(double) == 0;
    if (from.owner && aligned && from.bytes.size() >= many)
      return Values::lent(reinterpret_cast<const double*>(from.bytes.data()), r, c, from.owner);
    Eigen::MatrixXd copy(r, c);
    if (!from.bytes.empty()) std::memcpy(copy.data(), from.bytes.data(), from.bytes.size());
    return copy;
  }

  Rules rules_;
  const Parts& parts_;
  std::size_t next_ = 1;
};

}  // namespace strake::wire
