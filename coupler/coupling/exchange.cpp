#include "coupler/coupling/exchange.hpp"

#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <string>

namespace strake {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Units of what Strake's own solvers and the sums of history.csv take.
const std::map<std::string, std::string> units_of_vectors = {
    {"displacement", "m"}, {"velocity", "m/s"}, {"force", "N"}};

void check_announced(const std::vector<Field>& fields, const Participant& participant, const char* name) {
  const Index n = participant.mesh().position.cols();
  const auto refuse = [&](const std::string& problem) {
    throw Error(ExitCode::solver_fault, name, problem, "see Ready in proto/WIRE.md");
  };
  for (const Field& field : fields) {
    if (field.value.cols() != n || field.value.rows() == 0)
      refuse(fmt::format("its {} at the start is {}×{} and does not fit its mesh of {} points",
                         field.quantity, field.value.rows(), field.value.cols(), n));
    const auto unit = units_of_vectors.find(field.quantity);
    const bool vector = unit != units_of_vectors.end();
    if (vector && !field.unit.empty() && field.unit != unit->second)
      refuse(fmt::format("it announces {} in \"{}\", expected \"{}\"", field.quantity, field.unit,
                         unit->second));
    if (vector && field.value.rows() != 3)
      refuse(
          fmt::format("its {} has {} components, not 3 (z = 0 in 2-D)", field.quantity, field.value.rows()));
    const auto same = [&](const Field& other) { return other.quantity == field.quantity; };
    if (std::count_if(fields.begin(), fields.end(), same) > 1)
      refuse(fmt::format("it announces {} twice", field.quantity));
  }
}

/// The expected field out of the answer, checked.
Field received_field(std::vector<Field>& answer, const Field& expected, const InterfaceMesh& mesh,
                     const Place& place) {
  const auto found = std::find_if(answer.begin(), answer.end(),
                                  [&](const Field& field) { return field.quantity == expected.quantity; });
  if (found == answer.end())
    throw Error(ExitCode::solver_fault, place.text(), fmt::format("sent no {}", expected.quantity),
                "it must send what it announced at the start: displacement (structure) or force (fluid) "
                "where that was nothing");
  Values& value = found->value;
  if (value.rows() != expected.value.rows() || value.cols() != mesh.position.cols())
    throw Error(ExitCode::solver_fault, place.text(),
                fmt::format("sent a {} of {}×{}, its mesh needs {}×{}", expected.quantity, value.rows(),
                            value.cols(), expected.value.rows(), mesh.position.cols()));
  if (found->unit != expected.unit)
    throw Error(ExitCode::solver_fault, place.text(),
                fmt::format("sent {} in {}, announced in {}", expected.quantity, found->unit, expected.unit));
  if (!value.check_finite()) {
    Index i = 0;
    while (i + 1 < value.cols() && value.col(i).allFinite()) ++i;
    const auto X = mesh.position.col(i);
    throw Error(ExitCode::solver_fault, place.text(),
                fmt::format("the {} of interface point {}, X = ({:g}, {:g}, {:g}) m, is not finite",
                            expected.quantity, i, X.x(), X.y(), X.z()),
                "see its log; a smaller coupling window or solver step may help");
  }
  found->conservative = expected.conservative;
  return std::move(*found);
}

Field displacement_field(const Values& value) {
  return {"displacement", "m", false, value};
}

Field velocity_field(const Values& value) {
  return {"velocity", "m/s", false, value};
}

}  // namespace

std::vector<Field> StructureSample::fields() const {
  std::vector<Field> all;
  if (motion) all.push_back(displacement_field(motion->displacement));
  if (motion && motion->velocity.size() > 0) all.push_back(velocity_field(motion->velocity));
  all.insert(all.end(), others.begin(), others.end());
  return all;
}

StructureSample StructureSample::of(Sample sample) {
  StructureSample made = {sample.time, {}, {}};
  for (Field& field : sample.fields)
    if (field.quantity == "displacement")
      made.motion = Motion{std::move(field.value), {}};
    else if (made.motion && field.quantity == "velocity")
      made.motion->velocity = std::move(field.value);
    else
      made.others.push_back(std::move(field));
  return made;
}

StructureSample fields_of_structure(const Participant& structure) {
  const std::vector<Field>& initial = structure.description().initial;
  check_announced(initial, structure, "structure");
  const Field *u = find(initial, "displacement"), *v = find(initial, "velocity");
  if (!initial.empty() && !u && !v) return {0, {}, initial};
  const Values none = MatrixXd::Zero(3, structure.mesh().position.cols());
  StructureSample sent = {0, Motion{u ? u->value : none, v ? v->value : none}, {}};
  for (const Field& field : initial)
    if (&field != u && &field != v) sent.others.push_back(field);
  return sent;
}

std::vector<Field> fields_of_fluid(const Participant& fluid) {
  const std::vector<Field>& initial = fluid.description().initial;
  check_announced(initial, fluid, "fluid");
  if (!initial.empty()) return initial;
  return {{"force", "N", true, MatrixXd::Zero(3, fluid.mesh().position.cols())}};
}

std::string Place::text() const {
  return fmt::format("{}, window {} (t = {:g} s), iteration {}", name, number, window.t, iteration);
}

std::vector<Field> received_fields(std::vector<Field>&& answer, const std::vector<Field>& announced,
                                   const InterfaceMesh& mesh, const Place& place) {
  std::vector<Field> taken;
  for (const Field& expected : announced) taken.push_back(received_field(answer, expected, mesh, place));
  return taken;
}

StructureSample received_fields(std::vector<Field>&& answer, const StructureSample& announced,
                                const InterfaceMesh& mesh, const Place& place) {
  StructureSample taken = {place.window.t + place.window.dt, {}, {}};
  if (const auto& motion = announced.motion) {
    taken.motion =
        Motion{received_field(answer, displacement_field(motion->displacement), mesh, place).value, {}};
    if (find(answer, "velocity"))
      taken.motion->velocity = received_field(answer, velocity_field(motion->velocity), mesh, place).value;
  }
  taken.others = received_fields(std::move(answer), announced.others, mesh, place);
  return taken;
}

void correct_start(const StructureSample& start, const StructureSample& first, StructureSample& second) {
  const double dt1 = first.time - start.time, dt2 = second.time - first.time;
  if (!start.motion || !first.motion || !second.motion || !(dt1 > 0) || !(dt2 > 0)) return;
  const Values &x0 = start.motion->displacement, &x1 = first.motion->displacement,
               &x2 = second.motion->displacement;
  MatrixXd velocity = second.motion->velocity;
  bool changed = false;
  for (Index i = 0; i < velocity.cols(); ++i) {
    const Eigen::Vector3d d1 = (x1.col(i) - x0.col(i)) / dt1, d2 = (x2.col(i) - x1.col(i)) / dt2,
                          v2 = d2 + (d2 - d1) * (dt2 / (dt1 + dt2));
    if (!(d1.norm() > 2 * (d2 - d1).norm()) || !((v2 - velocity.col(i)).norm() > 0.5 * d1.norm())) continue;
    velocity.col(i) = v2;
    changed = true;
  }
  if (changed) second.motion->velocity = std::move(velocity);
}

FieldTransfer::FieldTransfer(Mapping to_fluid, std::optional<Mapping> to_structure)
    : to_fluid_(std::move(to_fluid)), to_structure_(std::move(to_structure)) {}

FieldTransfer::FieldTransfer(Mapping to_fluid, std::optional<Mapping> to_structure,
                             std::vector<Crossing> crossings, std::optional<Mapping> to_loaded)
    : to_fluid_(std::move(to_fluid)),
      to_structure_(std::move(to_structure)),
      crossings_(std::move(crossings)),
      to_loaded_(std::move(to_loaded)) {}

bool FieldTransfer::needs_way_back(Sender sender, const Field& field) {
  return field.conservative == (sender == Sender::structure);
}

bool FieldTransfer::needs_way_back(const StructureSample& of_structure, const std::vector<Field>& of_fluid) {
  const auto back = [](Sender sender) {
    return [sender](const Field& field) { return needs_way_back(sender, field); };
  };
  return std::any_of(of_structure.others.begin(), of_structure.others.end(), back(Sender::structure)) ||
         std::any_of(of_fluid.begin(), of_fluid.end(), back(Sender::fluid));
}

const Crossing* FieldTransfer::find(Sender sender, const std::string& quantity) const {
  for (const Crossing& one : crossings_)
    if (one.sender == sender && one.quantity == quantity) return &one;
  return nullptr;
}

const Mapping& FieldTransfer::way_of(Sender sender, const Field& field) const {
  if (const Crossing* own = find(sender, field.quantity)) return own->mapping;
  const bool back = needs_way_back(sender, field);
  assert(!back || to_structure_);
  return back ? *to_structure_ : to_fluid_;
}

Field FieldTransfer::onto_fluid(const Field& field) const {
  const Mapping& way = way_of(Sender::structure, field);
  return field.conservative ? way.conservative(field) : way.consistent(field);
}

Field FieldTransfer::onto_structure(const Field& field) const {
  const Mapping& way = way_of(Sender::fluid, field);
  return field.conservative ? way.force(field) : way.per_area(field);
}

Field FieldTransfer::onto_moving(const Field& force) const {
  return to_loaded_ ? to_loaded_->conservative(force) : force;
}

Field FieldTransfer::where_fluid_loads(const Field& displacement) const {
  const Crossing* force = find(Sender::fluid, "force");
  return (force ? force->mapping : to_fluid_)
      .consistent(to_loaded_ ? to_loaded_->consistent(displacement) : displacement);
}

double FieldTransfer::rms_factor(Sender sender, const std::string& quantity) const {
  const Crossing* own = find(sender, quantity);
  if (!own || own->structure_points == 0) return 1;
  return std::sqrt(static_cast<double>(to_fluid_.weights().cols()) /
                   static_cast<double>(own->structure_points));
}

}  // namespace strake
