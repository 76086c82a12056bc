#pragma once

#include "coupler/case/case_view.hpp"
#include "coupler/coupling/attachments.hpp"
#include "coupler/processes/remote.hpp"

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace strake {

/// The solvers of a run's attachments, in this process or in their own.
class SessionAttachments {
 public:
  /// view lives longer. launch: starts the program of one.
  SessionAttachments(const CaseView& view, const std::function<void(const AttachmentKeys&)>& launch);
  /// Finds the points on the structure, and sets all solvers up. structure: of several bodies all in one.
  /// Throws Error(case_file) for a point away from the body's surface.
  void connect(Participants&, Setup, const Participant& structure);

  const std::vector<Attachment>& all() const { return all_; }
  const std::vector<RemoteParticipant*>& remotes() const { return remotes_; }
  /// Their columns, each name behind the attachment's, with the force on it.
  std::vector<Column> columns() const;
  /// For the console: the name and what is known of it.
  const std::vector<std::pair<std::string, std::vector<std::string>>>& understood() const {
    return understood_;
  }
  /// Names of those that cannot save their state.
  std::vector<std::string> cannot_resume() const;
  void checkpoint(const std::filesystem::path& folder) const;
  void resume(const std::filesystem::path& folder, std::uint64_t windows) const;

 private:
  std::unique_ptr<Participant> make_local(const AttachmentKeys&, const Setup&) const;
  const CaseView& view_;
  std::vector<std::unique_ptr<Participant>> local_;
  std::vector<RemoteParticipant*> remotes_;
  std::vector<Attachment> all_;
  std::vector<std::pair<std::string, std::vector<std::string>>> understood_;
};

}  // namespace strake
