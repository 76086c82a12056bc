#include "coupler/run/session_attachments.hpp"

#include "coupler/attachments/local_attachment.hpp"
#include "coupler/mapping/mapping.hpp"
#include "proto/error.hpp"
#include "proto/lookup.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace strake {
namespace {

using Eigen::Index;

/// A point farther than this from the body's surface is not on it: of fluid.spacing, or where that is not
/// given of the body's extent.
constexpr double farthest_of_spacing = 1.0, farthest_of_extent = 0.01;

/// The body that is attached to, and where its points begin in the structure's mesh.
struct AttachedBody {
  InterfaceMesh mesh;
  Index first = 0;
};

AttachedBody body_of(const AttachmentKeys& keys, const InterfaceMesh& structure) {
  AttachedBody body;
  Index end = structure.position.cols(), first_face = 0, end_face = structure.faces.cols();
  for (std::size_t k = 0; k < structure.parts.size(); ++k) {
    if (structure.parts[k].name != keys.body) continue;
    body.first = structure.parts[k].first_point;
    first_face = structure.parts[k].first_face;
    if (k + 1 == structure.parts.size()) continue;
    end = structure.parts[k + 1].first_point;
    end_face = structure.parts[k + 1].first_face;
  }
  body.mesh.name = keys.body;
  body.mesh.dimension = structure.dimension;
  body.mesh.position = structure.position.middleCols(body.first, end - body.first);
  body.mesh.faces =
      structure.faces.middleCols(first_face, end_face - first_face).array() - static_cast<int>(body.first);
  return body;
}

InterfaceMesh points_of(const AttachmentKeys& keys, int dimension) {
  InterfaceMesh mesh;
  mesh.name = keys.name;
  mesh.dimension = dimension;
  mesh.position.resize(3, static_cast<Index>(keys.at.size()));
  for (std::size_t k = 0; k < keys.at.size(); ++k) mesh.position.col(static_cast<Index>(k)) = keys.at[k];
  if (dimension == 2) mesh.position.row(2).setZero();
  mesh.faces.resize(dimension, 0);
  return mesh;
}

/// W on the points of the whole structure: the nearest face of the body, or its nearest point.
Mapping mapping_to(const InterfaceMesh& points, const AttachedBody& body, Index n) {
  const Mapping own = body.mesh.faces.cols() > 0 ? nearest_projection(body.mesh, points)
                                                 : nearest_neighbour(body.mesh, points);
  SparseOperator::Matrix weights(points.position.cols(), n);
  std::vector<Eigen::Triplet<double>> entries;
  for (Index row = 0; row < own.weights().rows(); ++row)
    for (SparseOperator::Matrix::InnerIterator entry(own.weights(), row); entry; ++entry)
      entries.emplace_back(static_cast<int>(row), static_cast<int>(entry.col() + body.first), entry.value());
  weights.setFromTriplets(entries.begin(), entries.end());
  return Mapping(std::move(weights), own.quality());
}

void check_distance(const AttachmentKeys& keys, const Mapping& mapping, double limit) {
  const MappingQuality& quality = mapping.quality();
  if (quality.largest_distance <= limit) return;
  throw Error(ExitCode::case_file, "attachments." + keys.name + ".at",
              fmt::format("point {} is {:.4g} m from the body's surface, at most {:.4g} m is taken for on it",
                          quality.farthest + 1, quality.largest_distance, limit),
              "give places on the surface, in the reference configuration");
}

}  // namespace

SessionAttachments::SessionAttachments(const CaseView& view,
                                       const std::function<void(const AttachmentKeys&)>& launch)
    : view_(view) {
  for (const AttachmentKeys& keys : view.attachments)
    if (keys.is_program()) launch(keys);
}

void SessionAttachments::connect(Participants& participants, Setup setup, const Participant& structure) {
  if (view_.attachments.empty()) return;
  const InterfaceMesh& mesh = structure.mesh();
  if (!mesh.meshes.empty())
    throw Error(ExitCode::case_file, "attachments",
                fmt::format("the structure has {} meshes, and attachments need one for motion and force",
                            mesh.meshes.size()),
                "give all data of the structure on one mesh, or leave out [[attachments]]");
  const auto motion = fields_of_structure(structure).motion;
  if (!motion)
    throw Error(ExitCode::case_file, "attachments", "the structure sends no displacement",
                "leave out [[attachments]]");
  const double extent = (mesh.position.rowwise().maxCoeff() - mesh.position.rowwise().minCoeff()).maxCoeff();
  const double limit = view_.number("fluid.spacing") ? farthest_of_spacing * *view_.number("fluid.spacing")
                                                     : farthest_of_extent * extent;
  for (const AttachmentKeys& keys : view_.attachments) {
    const AttachedBody body = body_of(keys, mesh);
    setup.partner_mesh = points_of(keys, mesh.dimension);
    const Mapping mapping = mapping_to(setup.partner_mesh, body, mesh.position.cols());
    check_distance(keys, mapping, limit);
    SparseOperator to_points{SparseOperator::Matrix(mapping.weights())};
    setup.partner_initial = {{"displacement", "m", false, to_points * motion->displacement},
                             {"velocity", "m/s", false, to_points * motion->velocity}};
    setup.history = false;
    Participant* solver = nullptr;
    std::vector<std::string> lines = {fmt::format(
        "{}   {} point{}{}",
        keys.is_users() ? std::filesystem::path(keys.solver).filename().string() : keys.solver,
        keys.at.size(), keys.at.size() == 1 ? "" : "s", keys.body.empty() ? "" : " of " + keys.body)};
    if (keys.is_program()) {
      RemoteParticipant& remote = participants.connect(keys.name, setup);
      remotes_.push_back(&remote);
      solver = &remote;
      if (!remote.description().lines.empty()) lines = remote.description().lines;
    } else {
      local_.push_back(make_local(keys, setup));
      solver = local_.back().get();
    }
    all_.push_back({keys.name, solver, std::move(to_points)});
    understood_.emplace_back(keys.name, std::move(lines));
  }
}

std::unique_ptr<Participant> SessionAttachments::make_local(const AttachmentKeys& keys,
                                                            const Setup& setup) const {
  std::unique_ptr<LineLaw> law;
  if (keys.solver == "spring") {
    law = std::make_unique<SpringLaw>(keys.spring);
  } else {
    CatenaryParameters line = keys.catenary;
    const std::vector<double> gravity = numbers_in(at_or(view_.value, "fluid.gravity", "[0, -9.81, 0]"));
    line.down = gravity.size() == 3 ? Eigen::Vector3d(gravity[0], gravity[1], gravity[2])
                                    : Eigen::Vector3d(gravity.at(0), gravity.at(1), 0);
    if (line.down.norm() == 0)
      throw Error(ExitCode::case_file, "attachments." + keys.name, "a catenary needs fluid.gravity",
                  "solver = \"spring\" where there is none");
    line.down.normalize();
    law = std::make_unique<CatenaryLaw>(std::move(line));
  }
  const Motion initial{setup.partner_initial[0].value, setup.partner_initial[1].value};
  return std::make_unique<LocalAttachment>(keys.name, setup.partner_mesh, initial, std::move(law));
}

std::vector<Column> SessionAttachments::columns() const {
  std::vector<Column> columns;
  for (const Attachment& one : all_) {
    const int dimension = one.solver->mesh().dimension;
    for (int k = 0; k < dimension; ++k)
      columns.push_back({fmt::format("{}.force.{}", one.name, "xyz"[k]), dimension == 2 ? "N/m" : "N"});
    for (const Column& own : one.solver->description().columns)
      columns.push_back({one.name + "." + own.name, own.unit});
  }
  return columns;
}

std::vector<std::string> SessionAttachments::cannot_resume() const {
  std::vector<std::string> names;
  for (const Attachment& one : all_)
    if (one.solver->description().cannot_resume) names.push_back(one.name);
  return names;
}

void SessionAttachments::checkpoint(const std::filesystem::path& folder) const {
  for (const Attachment& one : all_) one.solver->checkpoint(folder);
}

void SessionAttachments::resume(const std::filesystem::path& folder, std::uint64_t windows) const {
  for (const Attachment& one : all_) one.solver->resume(folder);
  for (RemoteParticipant* remote : remotes_) remote->count_windows_from(windows);
}

}  // namespace strake
