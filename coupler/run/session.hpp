#pragma once

#include "coupler/case/case_view.hpp"
#include "coupler/coupling/assembly.hpp"
#include "coupler/coupling/scheme.hpp"
#include "coupler/coupling/window_loop.hpp"
#include "coupler/processes/remote.hpp"
#include "coupler/run/session_attachments.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace strake {

class StopRequest;

/// The processes of a case, started and set up, and the scheme between them.
class Session {
 public:
  struct Options {
    std::filesystem::path run_folder;     // absolute; empty: the participants write nothing (`check`)
    std::filesystem::path log_folder;     // absolute
    std::optional<long> resumed_at = {};  // the window that a resumed run begins with: logs continue there
    bool patient = false;
    std::vector<std::string> by_hand = {};  // sides that are not started but waited for
    /// Side and command line of each of those; called before the wait.
    std::function<void(const std::string&, const std::string&)> invite = {};
    std::function<void(const std::string&)> say;        // one line, while waiting
    std::function<void(const std::string&)> note = {};  // of a wait like any other; empty: say
    const StopRequest* stop = nullptr;
    std::function<void(const Exchange&)> on_exchange = {};  // each question that is answered; may be empty
    std::function<void(const Awaited&)> on_wait = {};       // while one is not; may be empty
  };
  /// Starts both programs, sets up the structure, then the fluid with the structure's mesh and initial
  /// motion. Then builds the mapping. Throws Error; the processes are then ended and reaped.
  Session(const CaseView&, const Options&);

  /// The time loop over these participants.
  WindowLoop loop(const RunPlan&);
  RunPlan plan() const;                             // of the whole case
  Scheme* scheme() { return scheme_.get(); }        // nullptr with one participant
  Assembly* assembly() { return assembly_.get(); }  // nullptr with one body
  /// True if displacement and force cross the interface.
  bool is_mechanical() const { return scheme_ && scheme_->is_mechanical(); }
  RemoteParticipant* fluid() { return fluid_; }
  Participant* structure() { return structure_; }   // of several bodies all in one
  std::vector<RemoteParticipant*> remotes() const;  // without attachments
  const SessionAttachments& attachments() const { return *attachments_; }
  Participants& participants() { return *participants_; }

  /// What the participants report per window; of two columns with one name the second carries its side's
  /// name.
  const std::vector<Column>& columns() const { return columns_; }
  /// The values of those columns after a window; NaN where a participant did not report one.
  std::vector<double> values(const WindowReport&) const;
  /// "fluid", "structure", "coupling" with what each understood, the headline first.
  std::vector<std::pair<std::string, std::vector<std::string>>> understood() const;
  /// The quality of the mapping, a line each; empty without a surface between two participants.
  std::vector<std::string> mapping_lines() const;
  std::vector<std::string> warnings() const;
  /// "structure cannot save its state"; empty: every participant can.
  std::string cannot_resume() const;
  /// What the spacings resolve (coupler/summary/resolution.hpp).
  std::vector<std::string> resolution() const;
  int dimension() const;

 private:
  void set_up_structures(const Setup&);
  void take_surface(const SideView&, RemoteParticipant&) const;
  void add_forces();
  void add_columns(const std::string& side, const Description&);
  void launch(const SideView&);
  void launch_attachment(const AttachmentKeys&);
  void start(const std::string& name, Launch, bool started_here);
  std::vector<std::string> coupling_lines() const;

  const CaseView& case_;
  Options options_;
  std::unique_ptr<Participants> participants_;
  RemoteParticipant* fluid_ = nullptr;
  std::vector<RemoteParticipant*> bodies_;  // the structure, or several bodies
  std::unique_ptr<Assembly> assembly_;      // of several
  Participant* structure_ = nullptr;
  std::unique_ptr<SessionAttachments> attachments_;
  std::unique_ptr<Scheme> scheme_;
  enum class Reporter { fluid, structure, attachments };
  struct Source {
    Reporter reporter = Reporter::structure;
    std::string name;  // as the participant calls it
    std::size_t body = 0;
    int component = -1;  // of that body's force; -1: what a participant reports
  };
  std::vector<Column> columns_;
  std::vector<Source> sources_;  // of the columns
};

/// The window of a case: of its coupling, or the whole time of an analysis without one (static, modal).
double window_of(const CaseView&);
/// Ratio ρ a / (ρ_s h) for a plate of half length a and thickness h. It is the added mass of a strip of
/// structure relative to its own mass, of a rigid plate that of the case and what it carries. Nothing when
/// the case does not give it.
std::optional<double> added_mass_ratio(const CaseView&);

}  // namespace strake
