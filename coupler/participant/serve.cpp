#include "coupler/participant/serve.hpp"

#include "coupler/participant/conversation.hpp"
#include "coupler/participant/launch.hpp"
#include "coupler/participant/liveness_thread.hpp"
#include "coupler/transport/system_calls.hpp"
#include "proto/wire/wire.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <new>
#include <unistd.h>

namespace strake {
namespace {

/// Checks that coupler and participant use the same run folder. Both write checkpoints into it. The
/// participant does not make it.
void check_run_folder(const std::filesystem::path& folder, const std::string& name) {
  if (folder.empty()) return;
  const std::filesystem::path probe = folder / fmt::format(".{}-{}.part", name, getpid());
  const int file = open(probe.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file < 0)
    throw Error(ExitCode::cannot_write, folder.string(),
                fmt::format("{} cannot write into the run folder: {}", name, std::strerror(errno)));
  close(file);
  unlink(probe.c_str());
}

/// Names the machine with a path that cannot be written, if it is not the coupler's. The user looks there
/// then.
Error with_machine(const Error& e) {
  if (e.code() != ExitCode::cannot_write || started_by_coupler()) return e;
  const std::string shared =
      "the run folder has one path on all machines of a run: mount it there under that path,\n"
      "or choose a folder that they share with --runs DIR";
  return {e.code(), e.where(), e.problem() + "\non the machine " + host_name(),
          e.fix().empty() ? shared : e.fix() + "\n" + shared};
}

/// One participant and its conversation.
class Server {
 public:
  Server(const ServeOptions& options, const ParticipantFactory& factory)
      : options_(options), factory_(factory), conversation_(options) {}

  int run();
  void working(double fraction, const std::string& what) { conversation_.working(fraction, what); }

 private:
  /// False after Stop.
  bool answer(wire::Request);
  wire::Reply reply(const Setup&);
  wire::Reply reply(const wire::Advance&);
  wire::Reply reply(const wire::Checkpoint&);
  wire::Reply reply(const wire::Stop&);
  wire::Reply reply(const wire::Refused&);
  void settle(wire::Before, bool write_output);
  Participant& participant(const char* message);

  const ServeOptions& options_;
  const ParticipantFactory& factory_;
  Conversation conversation_;
  std::unique_ptr<Participant> participant_;
  bool stopped_ = false, refused_ = false;
};

thread_local Server* serving = nullptr;  // for working()

Participant& Server::participant(const char* message) {
  if (!participant_)
    throw Error(ExitCode::participant_lost, options_.name,
                fmt::format("the coupler sent {} before Setup", message));
  return *participant_;
}

void Server::settle(wire::Before before, bool write_output) {
  if (before == wire::Before::commit) participant_->commit(write_output);
  if (before == wire::Before::rewind) participant_->rewind();
}

wire::Reply Server::reply(const Setup& setup) {
  if (participant_) throw Error(ExitCode::participant_lost, options_.name, "the coupler sent Setup twice");
  check_run_folder(setup.run_folder, options_.name);
  participant_ = factory_(setup);
  take_signals();
  const Description& description = participant_->description();
  for (const std::string& text : description.lines) spdlog::info(text);
  return {0, wire::Ready{participant_->mesh(), description}};
}

wire::Reply Server::reply(const wire::Advance& advance) {
  Participant& p = participant("Advance");
  for (const Sample& sample : advance.input.samples)
    for (const Field& field : sample.fields)
      if (field.value.cols() != p.mesh().position.cols())
        throw Error(ExitCode::participant_lost, options_.name,
                    fmt::format("the coupler sent {} at {} points, the mesh has {}", field.quantity,
                                field.value.cols(), p.mesh().position.cols()));
  settle(advance.before, advance.write_output);
  return {0, p.advance(advance.window, advance.input)};
}

wire::Reply Server::reply(const wire::Checkpoint& checkpoint) {
  Participant& p = participant("Checkpoint");
  settle(checkpoint.before, checkpoint.write_output);
  if (checkpoint.resume)
    p.resume(checkpoint.folder);
  else
    p.checkpoint(checkpoint.folder);
  return {0, wire::Done{}};
}

wire::Reply Server::reply(const wire::Stop& stop) {
  if (participant_ && stop.commit) participant_->commit(stop.write_output);
  if (participant_) participant_->flush();
  participant_.reset();  // Done means that everything is written
  stopped_ = true;
  return {0, wire::Done{}};
}

wire::Reply Server::reply(const wire::Refused& refused) {
  refused_ = true;  // no coupler listens to this participant
  throw Error(ExitCode::participant_lost, options_.name,
              "the coupler refused this participant: " + refused.problem, refused.fix);
}

bool Server::answer(wire::Request request) {
  conversation_.answer(std::visit([this](const auto& what) { return reply(what); }, request.what));
  return !stopped_;
}

int Server::run() {
  serving = this;
  const auto fault = [this](const Error& e) {
    spdlog::error(to_text(e));
    if (!refused_) conversation_.answer({0, wire::Fault{e.where(), e.problem(), e.fix(), e.code()}});
    return static_cast<int>(e.code());
  };
  int code = 0;
  try {
    while (answer(conversation_.next())) {
    }
  } catch (const Error& e) {
    code = fault(with_machine(e));
  } catch (const std::bad_alloc&) {
    code = fault(
        Error(ExitCode::solver_fault, options_.name, "is out of memory", "a coarser spacing needs less"));
  } catch (const std::exception& e) {
    code = fault(
        Error(ExitCode::our_bug, options_.name, fmt::format("unexpected: {}", e.what()), "please report it"));
  }
  serving = nullptr;
  return code;
}

}  // namespace

int serve(const ServeOptions& options, const ParticipantFactory& factory) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // a log is read while it is written, and ends with the process
  prepare_last_moments(options.name, options.endpoint);
  tune_malloc();
  spdlog::flush_on(spdlog::level::info);
  spdlog::info(fmt::format("{} {} as {}, process {}, coupler at {}", options.solver, options.version,
                           options.name, getpid(), options.endpoint));
  try {
    return Server(options, factory).run();
  } catch (const Error& e) {  // before the coupler could receive it
    spdlog::error(to_text(e));
    return static_cast<int>(e.code());
  }
}

void working(double fraction, const std::string& what) {
  if (serving) serving->working(fraction, what);
}

}  // namespace strake
