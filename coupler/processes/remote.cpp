#include "coupler/processes/remote.hpp"

#include "coupler/participant/launch.hpp"
#include "coupler/processes/participants_state.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>
#include <sodium.h>

#include <cassert>
#include <csignal>
#include <unistd.h>
#include <utility>

namespace strake {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds to_write_out{500};  // what an idle participant gets for its last files after an error
constexpr milliseconds to_obey{300};       // between SIGTERM and SIGKILL
constexpr milliseconds to_leave{5000};     // between Done and the end of the process

/// Fields of an answer must fit the mesh that the participant announced.
void check_fields(const std::vector<Field>& fields, const InterfaceMesh& mesh, const std::string& place,
                  const std::string& fix) {
  for (const Field& f : fields)
    if (f.value.cols() != mesh.position.cols())
      throw Error(ExitCode::participant_lost, place,
                  fmt::format("sent {} at {} points, its mesh has {}", f.quantity, f.value.cols(),
                              mesh.position.cols()),
                  fix);
}

}  // namespace

// ---- Participants

Participants::Participants(Options options) : state_(std::make_unique<State>(std::move(options))) {
  tune_malloc();
}

Participants::~Participants() {
  end();
}

std::string Participants::endpoint() const {
  return state_->socket.endpoint();
}
const std::string& Participants::token() const {
  return state_->token;
}

void Participants::attach(const std::string& name) {
  assert(!state_->find(name) && "a name is taken once");
  const auto& keys = state_->options.keys;
  if (keys && !keys->admitted.contains(name))
    throw Error(ExitCode::case_file, key_file(keys->folder, "coupler").string(),
                fmt::format("admits no participant \"{}\"", name),
                fmt::format("strake keys DIR --for {} (and all others of this case)", name));
  auto m = std::make_unique<Member>();
  m->name = name;
  m->expected_since = Clock::now();
  m->tell_after = state_->options.deadlines.tell;
  state_->members.push_back(std::move(m));
}

std::vector<std::string> Participants::State::arguments(const std::string& endpoint, const std::string& name,
                                                        const Launch& launch) const {
  if (launch.own_command_line) return launch.arguments;
  const std::string hash = hexadecimal(options.case_hash);
  std::vector<std::string> all{"--connect", endpoint, "--name", name, "--case-hash", hash};
  all.insert(all.end(), launch.arguments.begin(), launch.arguments.end());
  return all;
}

std::map<std::string, std::string> Participants::State::connection(const std::string& endpoint,
                                                                   const std::string& name) const {
  return {{"STRAKE_CONNECT", endpoint},
          {"STRAKE_NAME", name},
          {"STRAKE_CASE_HASH", hexadecimal(options.case_hash)}};
}

std::string Participants::command(const std::string& name, const Launch& launch) const {
  const std::string connect = state_->socket.endpoint_elsewhere();
  std::map<std::string, std::string> environment = solver_environment(launch.threads);
  environment.merge(state_->connection(connect, name));
  for (const auto& [variable, value] : launch.environment) environment[variable] = value;
  if (const auto& keys = state_->options.keys) environment["STRAKE_KEY"] = key_file(keys->folder, name);
  std::string line = launch.folder.empty() ? "" : "env -C " + shell_word(launch.folder.string()) + " ";
  line += "STRAKE_TOKEN=" + state_->token;
  for (const auto& [variable, value] : environment) line += " " + variable + "=" + shell_word(value);
  line += " " + shell_word(launch.program.string());
  for (const std::string& word : state_->arguments(connect, name, launch)) line += " " + shell_word(word);
  return line;
}

void Participants::launch(const std::string& name, Launch launch) {
  launch.arguments = state_->arguments(endpoint(), name, launch);
  launch.environment.merge(state_->connection(endpoint(), name));
  launch.environment["STRAKE_TOKEN"] = state_->token;
  launch.environment["STRAKE_COUPLER"] = std::to_string(getpid());
  launch.environment["STRAKE_COUPLER_FOLDER"] = state_->socket.private_folder();
  const auto& keys = state_->options.keys;
  launch.environment["STRAKE_KEY"] = keys ? key_file(keys->folder, name).string() : "";
  attach(name);
  Member& m = *state_->members.back();
  m.log = launch.log;
  m.launcher = launch.launcher;
  m.ours = launch.program.filename().string().starts_with("strake-");
  m.child.emplace(launch);
}

RemoteParticipant& Participants::connect(const std::string& name, const Setup& setup) {
  Member* m = state_->find(name);
  assert(m && !m->remote && "launch or attach first; connect once");
  state_->await_hello(*m);
  state_->ask(*m, {0, setup});
  auto ready = state_->await_as<wire::Ready>(*m);
  m->mesh = std::move(ready.mesh);
  m->description = std::move(ready.description);
  check_fields(m->description.initial, m->mesh, m->name, m->see_log());
  m->remote.reset(new RemoteParticipant(*state_, *m));
  return *m->remote;
}

void Participants::finish() {
  for (const auto& m : state_->members) {
    if (!m->connection.greeted) continue;
    state_->ask(*m, {0, wire::Stop{m->progress.before == wire::Before::commit, m->progress.write_output}});
    m->progress.before = wire::Before::nothing;
    state_->await_as<wire::Done>(*m);
    m->connection.greeted = false;  // from here on it may leave
    state_->await_end(*m);
  }
  end();
}

/// Of its process, after its last answer.
void Participants::State::await_end(Member& member) const {
  Member* m = &member;
  if (!m->child) return;
  const auto exit = m->child->wait(to_leave);
  const std::string problem = !exit ? fmt::format("{} has not ended {} s after its last answer", m->process(),
                                                  to_leave.count() / 1000)
                              : exit->code != 0 || exit->signal != 0
                                  ? fmt::format("{} {} after its last answer", m->process(), to_text(*exit))
                                  : "";
  if (!problem.empty()) say(fmt::format("{}: {}; {}", m->name, problem, m->see_log()));
  m->child.reset();
}

bool Participants::come_to_rest() noexcept {
  try {
    for (const auto& m : state_->members) {
      if (!m->connection.greeted || m->broken) return false;
      if (!m->asked.empty()) state_->await(*m);
      if (m->progress.iteration > 0 && m->progress.before == wire::Before::nothing)
        m->progress.before = wire::Before::rewind;
      m->progress.iteration = 0;
    }
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

void Participants::end() noexcept {
  State& s = *state_;
  if (std::exchange(s.ended, true)) return;
  try {
    std::size_t awaited = 0;  // participants started by hand whose Done is still to come
    const auto idle = [&](const Member& m) {
      return m.connection.greeted && m.asked.empty() && !m.broken && s.socket.connected(m.connection.peer);
    };
    for (const auto& m : s.members) {
      if (idle(*m)) {
        s.ask(*m, {0, wire::Stop{m->progress.before == wire::Before::commit, m->progress.write_output}});
        if (!m->child) ++awaited;
      } else if (m->child) {
        m->child->signal(SIGTERM);
      }
    }
    const auto limit = Clock::now() + to_write_out;
    const auto running = [&] {
      for (const auto& m : s.members)
        if (m->child && !m->child->exit()) return true;
      return false;
    };
    while ((running() || awaited > 0) && Clock::now() < limit) {
      if (const auto message = s.socket.receive(milliseconds(10)))
        for (const auto& m : s.members)
          if (m->connection.peer == message->peer && !m->child && awaited > 0) --awaited;
    }
    for (const auto& m : s.members)
      if (m->child) m->child->signal(SIGTERM);
    for (const auto& m : s.members)
      if (m->child) m->child->end(to_obey);
    for (const auto& m : s.members) m->child.reset();
    end_orphans();
  } catch (...) {  // the processes are ended by the destructors of Child
  }
}

// ---- RemoteParticipant

RemoteParticipant::RemoteParticipant(Participants::State& participants, Participants::Member& member)
    : participants_(&participants), member_(&member) {}

const InterfaceMesh& RemoteParticipant::mesh() const {
  return member_->mesh;
}
const Description& RemoteParticipant::description() const {
  return member_->description;
}

void RemoteParticipant::give_faces(const Eigen::MatrixXi& faces, const std::string& of_mesh) {
  InterfaceMesh& mesh = member_->mesh;
  Eigen::Index point = 0, face = 0;
  bool after = false;  // the meshes behind the one that gets faces
  for (MeshPart& part : mesh.meshes) {
    if (after) part.first_face += faces.cols();
    if (part.name != of_mesh) continue;
    point = part.first_point;
    face = part.first_face;
    after = true;
  }
  const Eigen::MatrixXi before = std::move(mesh.faces);
  const Eigen::Index rest = before.cols() - face;
  mesh.faces.resize(faces.rows(), before.cols() + faces.cols());
  mesh.faces.middleCols(face, faces.cols()) = faces.array() + static_cast<int>(point);
  if (face > 0) mesh.faces.leftCols(face) = before.leftCols(face);
  if (rest > 0) mesh.faces.rightCols(rest) = before.rightCols(rest);
}

void RemoteParticipant::count_windows_from(std::uint64_t committed) {
  member_->progress.committed = committed;
}

void RemoteParticipant::start(const Window& window, const Input& input) {
  start_with(window, Input(input));
}

void RemoteParticipant::start_with(const Window& window, Input&& input) {
  Participants::Member& m = *member_;
  participants_->check_stop_between(m);
  assert(m.asked.empty() && "one request at a time");
  assert((m.progress.iteration == 0 || m.progress.before != wire::Before::nothing) &&
         "rewind or commit first");
  m.progress.window = window;
  ++m.progress.iteration;
  const wire::Before before = std::exchange(m.progress.before, wire::Before::nothing);
  wire::Advance advance{before, window, m.progress.iteration, std::move(input),
                        std::exchange(m.progress.write_output, false)};
  participants_->ask(m, {0, std::move(advance)});
}

Advanced RemoteParticipant::finish() {
  Participants::Member& m = *member_;
  Advanced advanced = participants_->await_as<Advanced>(m);
  try {
    check_fields(advanced.output, m.mesh, m.place(), m.see_log());
  } catch (const Error&) {
    m.broken = true;
    throw;
  }
  return advanced;
}

void RemoteParticipant::rewind() {
  assert(member_->asked.empty() && member_->progress.iteration != 0);
  member_->progress.before = wire::Before::rewind;
}

void RemoteParticipant::commit(bool write_output) {
  assert(member_->asked.empty() && member_->progress.iteration != 0);
  member_->progress.before = wire::Before::commit;
  member_->progress.write_output = write_output;
  member_->progress.iteration = 0;
  ++member_->progress.committed;
}

void RemoteParticipant::checkpoint(const std::filesystem::path& folder) {
  Participants::Member& m = *member_;
  const wire::Before before = std::exchange(m.progress.before, wire::Before::nothing);
  participants_->ask(m, {0, wire::Checkpoint{folder.string(), false, before,
                                             std::exchange(m.progress.write_output, false)}});
  participants_->await_as<wire::Done>(m);
}

void RemoteParticipant::resume(const std::filesystem::path& folder) {
  participants_->ask(*member_, {0, wire::Checkpoint{folder.string(), true}});
  participants_->await_as<wire::Done>(*member_);
}

}  // namespace strake
