#include "coupler/attachments/local_attachment.hpp"

#include "proto/error.hpp"
#include "proto/files/result_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace strake {

using Eigen::MatrixXd;

LocalAttachment::LocalAttachment(std::string name, InterfaceMesh points, const Motion& initial,
                                 std::unique_ptr<LineLaw> law)
    : name_(std::move(name)), points_(std::move(points)), law_(std::move(law)) {
  const auto n = static_cast<std::size_t>(points_.position.cols());
  tension_.resize(n);
  committed_ = last_ = forces(initial.displacement, initial.velocity);
  description_.initial = {{"force", "N", true, committed_}};
  const char* unit = points_.dimension == 2 ? "N/m" : "N";
  for (std::size_t k = 0; k < n; ++k) description_.columns.push_back({column(k, "tension"), unit});
}

/// "tension" of one line, "tension.1" and so on of several.
std::string LocalAttachment::column(std::size_t line, const std::string& what) const {
  return tension_.size() == 1 ? what : fmt::format("{}.{}", what, line + 1);
}

MatrixXd LocalAttachment::forces(const Values& displacement, const Values& velocity) {
  MatrixXd forces(3, points_.position.cols());
  for (Eigen::Index k = 0; k < forces.cols(); ++k) {
    const Eigen::Vector3d place = points_.position.col(k) + displacement.col(k);
    const Eigen::Vector3d speed =
        velocity.cols() > 0 ? Eigen::Vector3d(velocity.col(k)) : Eigen::Vector3d(0, 0, 0);
    const LineForce line = law_->at(static_cast<std::size_t>(k), place, speed);
    forces.col(k) = line.force;
    tension_[static_cast<std::size_t>(k)] = line.tension;
  }
  return forces;
}

void LocalAttachment::start(const Window&, const Input& input) {
  const std::vector<Field>& end = input.samples.back().fields;
  last_ = forces(find(end, "displacement")->value, find(end, "velocity")->value);
}

Advanced LocalAttachment::finish() {
  Advanced answer;
  answer.output = {{"force", "N", true, MatrixXd(0.5 * (committed_ + last_))}};
  for (std::size_t k = 0; k < tension_.size(); ++k) answer.monitor[column(k, "tension")] = tension_[k];
  return answer;
}

void LocalAttachment::commit(bool /*write_output*/) {
  committed_ = last_;
}

void LocalAttachment::checkpoint(const std::filesystem::path& folder) {
  Archive archive;
  archive.real["force"] = committed_;
  write_archive(folder / (name_ + ".h5"), archive);
}

void LocalAttachment::resume(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / (name_ + ".h5");
  const Archive archive = read_archive(file);
  const auto found = archive.real.find("force");
  if (found == archive.real.end() || found->second.rows() != 3 || found->second.cols() != committed_.cols())
    throw Error(ExitCode::case_file, file.string(),
                fmt::format("has no force at {} points", committed_.cols()),
                "resume with the case that the checkpoint was made with");
  committed_ = last_ = found->second;
}

LineForce SpringLaw::at(std::size_t line, const Eigen::Vector3d& position,
                        const Eigen::Vector3d& velocity) const {
  const Eigen::Vector3d to_anchor = p_.anchor[line] - position;
  const double length = to_anchor.norm();
  // A spring of length zero pulls with −k x in every direction, and has no line where x = 0.
  if (p_.length[line] == 0 && !p_.slack)
    return {p_.stiffness * to_anchor - p_.damping * velocity, p_.stiffness * length};
  if (length == 0) return {};
  const Eigen::Vector3d line_of_action = to_anchor / length;
  const double rate = -line_of_action.dot(velocity);  // dL/dt
  double tension = p_.stiffness * (length - p_.length[line]) + p_.damping * rate;
  if (p_.slack) tension = length > p_.length[line] ? std::max(0.0, tension) : 0.0;
  return {tension * line_of_action, tension};
}

}  // namespace strake
