#pragma once

#include "coupler/participant/launch.hpp"
#include "coupler/processes/exchange_times.hpp"
#include "coupler/transport/curve_keys.hpp"
#include "proto/participant.hpp"

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace strake {

class StopRequest;
class RemoteParticipant;

struct Deadlines {
  std::chrono::duration<double> hello{30};  // [s] from launch to the first word
  std::chrono::duration<double> by_hand{
      600};  // [s] coupling.attach_within: to the first word of a participant started by hand
  std::chrono::duration<double> frozen_after{
      10};  // [s] coupling.frozen_after: no heartbeat though the process lives
  std::chrono::duration<double> answer_within{
      600};                                // [s] coupling.answer_within: one answer; Working restarts it
  std::chrono::duration<double> tell{15};  // [s] of waiting before the first line says for whom
  std::chrono::duration<double> grace{
      5};                // [s] for the answers under way after Ctrl-C, so that the state is saved
  bool patient = false;  // --patient: waits without limit for a program that lives
};

/// An answer that is awaited: whose, to what, and what that participant last said that it does.
struct Awaited {
  std::string name;   // "structure"
  std::string asked;  // "Advance"; empty: its first word
  std::string doing;  // "CalculiX computes all 300 windows"; empty: it has not said
  double part = 0;    // of that, in [0, 1]
  double waited = 0;  // [s]
};

/// All participants of a run: starts them, waits for them, receives their messages, ends them. A wait for any
/// participant ends with an Error that names the one at fault, whatever it did. Codes: participant_lost
/// (died, froze, never spoke, broke the protocol), the code of its own Fault, solver_fault (not finite),
/// interrupted or terminated (StopRequest).
class Participants {
 public:
  struct Options {
    std::string endpoint;                      // empty: ipc:// in a private folder; or "tcp://127.0.0.1:*"
    std::optional<CouplerKeys> keys;           // encrypted, and only for holders of a listed key
    bool unencrypted = false;                  // an endpoint beyond this machine without encryption keys is
                                               // intended
    std::array<std::uint8_t, 32> case_hash{};  // CaseFile::hash()
    Deadlines deadlines;
    std::function<void(const std::string&)> say;  // one line (no newline) for console and log; may be empty
    /// The same for a wait that is only that, until half of what it may last is over; empty: `say`.
    std::function<void(const std::string&)> note = {};
    const StopRequest* stop = nullptr;
    std::function<void(const Exchange&)> on_exchange = {};  // each question that is answered; may be empty
    std::function<void(const Awaited&)> on_wait =
        {};                  // about 20 times a second while one is not; may be empty
    std::string token = {};  // hexadecimal; empty: a new one
  };
  explicit Participants(Options);
  ~Participants();  // end()

  std::string endpoint() const;
  const std::string& token() const;  // hexadecimal; what a participant started by hand needs in STRAKE_TOKEN

  /// Starts the program with "--connect … --name `name` --case-hash …" put before launch.arguments. Its
  /// environment says the same, and holds the token. With launch.own_command_line it alone does.
  void launch(const std::string& name, Launch launch);
  /// Expects a participant started by hand (--attach).
  void attach(const std::string& name);
  /// The line for a shell that starts that participant, here or on another machine; it contains the token.
  std::string command(const std::string& name, const Launch&) const;
  /// Awaits its Hello, sends Setup, awaits Ready. Launch all, then connect the structure first.
  RemoteParticipant& connect(const std::string& name, const Setup&);
  /// Regular end: Stop (with the last commit) to each in turn, Done, exit 0, reaped. Error if one of them
  /// fails.
  void finish();
  /// Waits for the answers under way after Ctrl-C or SIGTERM in a window, and rewinds the window. The
  /// committed state can then be saved. False when a participant does not answer within the grace, or is
  /// lost.
  bool come_to_rest() noexcept;
  /// Ends the participants after an error. It sends Stop with the last commit to idle ones, at most 0.5 s,
  /// then SIGTERM, SIGKILL; all are reaped. Does nothing after finish().
  void end() noexcept;

 private:
  friend class RemoteParticipant;
  struct Member;
  struct State;
  std::unique_ptr<State> state_;
};

/// A participant in another process. `commit` and `rewind` ride on the next request, so they cost no round
/// trip. Lives as long as its Participants.
class RemoteParticipant final : public Participant {
 public:
  const InterfaceMesh& mesh() const override;
  const Description& description() const override;
  void start(const Window&, const Input&) override;
  void start_with(const Window&, Input&&) override;
  Advanced finish() override;
  void rewind() override;
  void commit(bool write_output) override;
  void checkpoint(const std::filesystem::path&) override;
  void resume(const std::filesystem::path&) override;

  /// Gives faces to a participant that sent its points alone; of several meshes to that of the name.
  void give_faces(const Eigen::MatrixXi&, const std::string& of_mesh = {});
  /// Windows committed before this run (resume), so that messages name the right window.
  void count_windows_from(std::uint64_t committed);

 private:
  friend class Participants;
  RemoteParticipant(Participants::State&, Participants::Member&);
  Participants::State* participants_;
  Participants::Member* member_;
};

}  // namespace strake
