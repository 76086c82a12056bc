#include "coupler/coupling/attachments.hpp"

#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace strake {
namespace {

using Eigen::MatrixXd;

std::vector<Field> announced_by(const Attachment& attachment) {
  const InterfaceMesh& mesh = attachment.solver->mesh();
  const Eigen::Index points = attachment.to_points.matrix().rows();
  if (mesh.position.cols() != points)
    throw Error(ExitCode::solver_fault, "attachments." + attachment.name,
                fmt::format("sent a mesh of {} points, it is attached at {}", mesh.position.cols(), points),
                "send the points of Setup.partner_mesh, in their order");
  const std::vector<Field> fields = fields_of_fluid(*attachment.solver);
  if (fields.size() != 1 || fields.front().quantity != "force" || fields.front().value.rows() != 3)
    throw Error(ExitCode::solver_fault, "attachments." + attachment.name,
                "announces other fields than the force on its points",
                "an attachment sends one field, \"force\" [N], with three components");
  return fields;
}

}  // namespace

Attachments::Attachments(std::vector<Attachment> attachments) {
  for (Attachment& one : attachments) {
    // f_s = Wᵀ g, by which g·(W u) = f_s·u: the work of the forces is kept.
    Attached attached{.of = one, .to_structure = one.to_points.transposed(), .announced = announced_by(one)};
    const Values force = attached.to_structure * attached.announced.front().value;
    if (none())
      load_ = force;
    else
      load_.edit() += force;
    dt_limit_ = std::min(dt_limit_, one.solver->description().dt_limit);
    attachments_.push_back(std::move(attached));
  }
}

void Attachments::start(const Window& window, const Motion& end) {
  for (const Attached& attached : attachments_) {
    const SparseOperator& to_points = attached.of.to_points;
    Input input;
    input.samples.push_back({window.t + window.dt,
                             {{"displacement", "m", false, to_points * end.displacement},
                              {"velocity", "m/s", false, to_points * end.velocity}}});
    attached.of.solver->start_with(window, std::move(input));
  }
}

std::optional<Attachments::Shorter> Attachments::finish(const Place& place) {
  std::optional<Shorter> shorter;
  if (none()) return shorter;
  load_ = MatrixXd(MatrixXd::Zero(3, load_.cols()));
  monitor_.clear();
  dt_limit_ = std::numeric_limits<double>::infinity();
  for (const Attached& attached : attachments_) {
    const Attachment& of = attached.of;
    Advanced answer = of.solver->finish();
    dt_limit_ = std::min(dt_limit_, answer.dt_limit);
    if (answer.retry_smaller_dt) {
      if (!shorter || answer.dt_limit < shorter->answer.dt_limit)
        shorter = Shorter{of.name, std::move(answer)};
      continue;
    }
    Place own = place;
    own.name = of.name.c_str();
    const std::vector<Field> sent =
        received_fields(std::move(answer.output), attached.announced, of.solver->mesh(), own);
    load_.edit() += attached.to_structure * sent.front().value;
    gather(of, sent.front().value, answer.monitor);
  }
  return shorter;
}

/// Reserved names ("seconds.solve") keep their prefix, so that the summary knows them.
void Attachments::gather(const Attachment& attachment, const Values& force,
                         const std::map<std::string, double>& own) {
  for (const auto& [name, value] : own) {
    const bool of_stage = name.starts_with("seconds.");
    const bool reserved = name.starts_with("count.") || name.starts_with("check.") ||
                          name.starts_with("memory.") || name.starts_with("alarm.");
    if (reserved)
      monitor_[name] = value;
    else if (of_stage)
      monitor_["seconds." + attachment.name + "." + name.substr(8)] = value;
    else
      monitor_[attachment.name + "." + name] = value;
  }
  const Eigen::Vector3d sum = force.sum_over_points();
  for (int k = 0; k < attachment.solver->mesh().dimension; ++k)
    monitor_[fmt::format("{}.force.{}", attachment.name, "xyz"[k])] = sum[k];
}

void Attachments::rewind() {
  for (const Attached& attached : attachments_) attached.of.solver->rewind();
}

void Attachments::commit(bool write_output) {
  for (const Attached& attached : attachments_) attached.of.solver->commit(write_output);
}

}  // namespace strake
