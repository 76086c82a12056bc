#include "proto/wire/wire.hpp"

#include "proto/coupling.pb.h"
#include "proto/wire/wire_arrays.hpp"
#include "proto/wire/wire_header.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace strake::wire {

static_assert(std::endian::native == std::endian::little && sizeof(double) == 8 && sizeof(int) == 4,
              "arrays travel as the memory of this machine: little-endian float64 and int32");

namespace {

pb::Advance::Before to_pb(Before before) {
  return static_cast<pb::Advance::Before>(before);
}
Before from_pb(pb::Advance::Before before, const Rules& rules) {
  if (before < 0 || before > 2)
    rules.broken(fmt::format("asks for {} before it, expected 0, 1 or 2", int{before}));
  return static_cast<Before>(before);
}

// ---- requests

void write(const Setup& from, pb::Setup& to, Writer& writer) {
  to.set_run_folder(from.run_folder.string());
  to.set_interface(from.interface);
  writer.mesh(from.partner_mesh, *to.mutable_partner_mesh());
  writer.fields(from.partner_initial, *to.mutable_partner_initial());
  to.set_history(from.history);
}
void write(const Setup& from, pb::Request& request, Writer& writer) {
  write(from, *request.mutable_setup(), writer);
}
template <class Repeated>
void write(const std::vector<Sample>& from, Repeated& to, Writer& writer) {
  for (const Sample& sample : from) {
    writer.rules().finite(sample.time, "the time of a sample");
    pb::Sample& header = *to.Add();
    header.set_time(sample.time);
    writer.fields(sample.fields, *header.mutable_fields());
  }
}
template <class Repeated>
std::vector<Sample> read_samples(const Repeated& from, Reader& reader) {
  std::vector<Sample> to;
  for (const pb::Sample& sample : from) {
    reader.rules().finite(sample.time(), "the time of a sample");
    to.push_back({sample.time(), reader.fields(sample.fields())});
  }
  return to;
}
void write(const Advance& from, pb::Request& request, Writer& writer) {
  pb::Advance& to = *request.mutable_advance();
  writer.rules().finite(from.window.t, "t");
  writer.rules().finite(from.window.dt, "dt");
  to.set_before(to_pb(from.before));
  to.set_t(from.window.t);
  to.set_dt(from.window.dt);
  to.set_iteration(from.iteration);
  to.set_write_output(from.write_output);
  to.set_wants_history(from.input.wants_history);
  write(from.input.samples, *to.mutable_samples(), writer);
}
void write(const Checkpoint& from, pb::Request& request, Writer&) {
  pb::Checkpoint& to = *request.mutable_checkpoint();
  to.set_folder(from.folder);
  to.set_resume(from.resume);
  to.set_before(to_pb(from.before));
  to.set_write_output(from.write_output);
}
void write(const Stop& from, pb::Request& request, Writer&) {
  request.mutable_stop()->set_commit(from.commit);
  request.mutable_stop()->set_write_output(from.write_output);
}
void write(const Refused& from, pb::Request& request, Writer&) {
  pb::Refused& to = *request.mutable_refused();
  to.set_where(from.where);
  to.set_problem(from.problem);
  to.set_fix(from.fix);
}

Setup read(const pb::Setup& from, Reader& reader) {
  Setup to;
  to.run_folder = from.run_folder();
  to.interface = from.interface();
  to.partner_mesh = reader.mesh(from.partner_mesh());
  to.partner_initial = reader.fields(from.partner_initial());
  to.history = from.history();
  return to;
}
Advance read(const pb::Advance& from, Reader& reader) {
  reader.rules().finite(from.t(), "t");
  reader.rules().finite(from.dt(), "dt");
  Advance to;
  to.before = from_pb(from.before(), reader.rules());
  to.window = {from.t(), from.dt()};
  to.iteration = from.iteration();
  to.write_output = from.write_output();
  to.input.samples = read_samples(from.samples(), reader);
  to.input.wants_history = from.wants_history();
  return to;
}

// ---- replies

void write(const Hello& from, pb::Reply& reply, Writer&) {
  pb::Hello& to = *reply.mutable_hello();
  to.set_protocol(from.protocol);
  to.set_name(from.name);
  to.set_token(from.token);
  to.set_solver(from.solver);
  to.set_version(from.version);
  to.set_case_hash(from.case_hash);
}
template <class Repeated>
void write(const std::map<std::string, std::string>& mesh_of, Repeated& to) {
  for (const auto& [quantity, mesh] : mesh_of) {
    pb::FieldMesh& one = *to.Add();
    one.set_quantity(quantity);
    one.set_mesh(mesh);
  }
}
void write(const Ready& from, pb::Reply& reply, Writer& writer) {
  pb::Ready& to = *reply.mutable_ready();
  const Description& d = from.description;
  writer.rules().limit(d.dt_limit);
  writer.rules().places(from.mesh, d);
  writer.mesh(from.mesh, *to.mutable_mesh());
  writer.fields(d.initial, *to.mutable_initial());
  to.set_dt_limit(d.dt_limit);
  to.set_history(d.history);
  to.set_partner_initial(d.partner_initial);
  to.set_prescribed(d.prescribed);
  to.set_cannot_resume(d.cannot_resume);
  write(d.sent_on, *to.mutable_sent_on());
  write(d.taken_on, *to.mutable_taken_on());
  writer.rules().columns(d.columns);
  for (const Column& c : d.columns) {
    to.add_columns()->set_name(c.name);
    to.mutable_columns()->rbegin()->set_unit(c.unit);
  }
  for (const std::string& line : d.lines) to.add_lines(line);
}
void write(const Advanced& from, pb::Reply& reply, Writer& writer) {
  pb::Advanced& to = *reply.mutable_advanced();
  writer.rules().limit(from.dt_limit);
  writer.fields(from.output, *to.mutable_fields());
  write(from.history, *to.mutable_history(), writer);
  to.set_dt_limit(from.dt_limit);
  to.mutable_monitor()->insert(from.monitor.begin(), from.monitor.end());
  to.set_retry_smaller_dt(from.retry_smaller_dt);
  to.set_why(from.why);
  to.set_fix(from.fix);
}
void write(const Done&, pb::Reply& reply, Writer&) {
  reply.mutable_done();
}
void write(const Fault& from, pb::Reply& reply, Writer&) {
  pb::Fault& to = *reply.mutable_fault();
  to.set_where(from.where);
  to.set_problem(from.problem);
  to.set_fix(from.fix);
  to.set_exit_code(static_cast<std::uint32_t>(from.code));
}
void write(const Working& from, pb::Reply& reply, Writer& writer) {
  writer.rules().finite(from.fraction, "fraction");
  reply.mutable_working()->set_fraction(from.fraction);
  reply.mutable_working()->set_what(from.what);
}

template <class Repeated>
std::map<std::string, std::string> read_places(const Repeated& from, const Rules& rules) {
  std::map<std::string, std::string> mesh_of;
  for (const pb::FieldMesh& one : from) {
    rules.label(one.quantity(), "quantity");
    if (!mesh_of.emplace(one.quantity(), one.mesh()).second)
      rules.broken(fmt::format("gives two meshes for {}, expected one", one.quantity()));
  }
  return mesh_of;
}
Ready read(const pb::Ready& from, Reader& reader) {
  reader.rules().limit(from.dt_limit());
  Ready to;
  to.mesh = reader.mesh(from.mesh());
  to.description.initial = reader.fields(from.initial());
  to.description.dt_limit = from.dt_limit();
  to.description.history = from.history();
  to.description.partner_initial = from.partner_initial();
  to.description.prescribed = from.prescribed();
  to.description.cannot_resume = from.cannot_resume();
  to.description.sent_on = read_places(from.sent_on(), reader.rules());
  to.description.taken_on = read_places(from.taken_on(), reader.rules());
  reader.rules().places(to.mesh, to.description);
  for (const pb::Column& c : from.columns()) to.description.columns.push_back({c.name(), c.unit()});
  reader.rules().columns(to.description.columns);
  to.description.lines.assign(from.lines().begin(), from.lines().end());
  return to;
}
Advanced read(const pb::Advanced& from, Reader& reader) {
  reader.rules().limit(from.dt_limit());
  Advanced to;
  to.output = reader.fields(from.fields());
  to.history = read_samples(from.history(), reader);
  to.dt_limit = from.dt_limit();
  for (const auto& [name, value] : from.monitor()) {
    reader.rules().label(name, "monitor");
    to.monitor[name] = value;
  }
  to.retry_smaller_dt = from.retry_smaller_dt();
  constexpr std::size_t longest_line = 1000;  // bytes
  for (const std::string& text : {from.why(), from.fix()}) reader.rules().label(text, "line", longest_line);
  to.why = from.why();
  to.fix = from.fix();
  return to;
}
/// A fault of a peer never counts as success, whatever number it gives.
Fault read(const pb::Fault& from) {
  ExitCode code = ExitCode::solver_fault;
  for (ExitCode known :
       {ExitCode::command_line, ExitCode::case_file, ExitCode::participant_lost, ExitCode::cannot_write,
        ExitCode::our_bug, ExitCode::hung_up, ExitCode::interrupted, ExitCode::terminated})
    if (from.exit_code() == static_cast<std::uint32_t>(known)) code = known;
  return {from.where(), from.problem(), from.fix(), code};
}

/// Names of the messages by their numbers in the oneof `what` (coupling.proto), for errors; 0: none is set.
constexpr std::array requests{"Request", "", "Setup", "Advance", "Checkpoint", "Stop", "Refused"};
constexpr std::array replies{"Reply", "", "Hello", "Ready", "Advanced", "Done", "Fault", "Working"};
constexpr std::size_t first_number = 2;

template <class Header, class Message>
Parts encode_any(Message message, const std::string& who) {
  const auto kept = std::make_shared<const Message>(std::move(message));
  Scratch scratch;
  Header& header = scratch.header<Header>();
  header.set_sequence(kept->sequence);
  if constexpr (std::is_same_v<Message, Reply>)
    if (kept->times.received != 0) {
      header.mutable_times()->set_received(kept->times.received);
      header.mutable_times()->set_answered(kept->times.answered);
    }
  Writer writer({who, name_of(*kept)}, kept);
  std::visit([&](const auto& what) { write(what, header, writer); }, kept->what);
  return writer.finish(header);
}

}  // namespace

Parts encode(Request request, const std::string& who) {
  return encode_any<pb::Request>(std::move(request), who);
}
Parts encode(Reply reply, const std::string& who) {
  return encode_any<pb::Reply>(std::move(reply), who);
}

Request decode_request(const Parts& parts, const std::string& who) {
  Scratch scratch;
  const auto& header = parse_header<pb::Request>(scratch, parts, {who, "Request"});
  const Rules rules{who, requests.at(header.what_case())};
  Reader reader(rules, parts);
  Request to;
  to.sequence = header.sequence();
  switch (header.what_case()) {
    case pb::Request::kSetup:
      to.what = read(header.setup(), reader);
      break;
    case pb::Request::kAdvance:
      to.what = read(header.advance(), reader);
      break;
    case pb::Request::kCheckpoint: {
      const pb::Checkpoint& c = header.checkpoint();
      to.what = Checkpoint{c.folder(), c.resume(), from_pb(c.before(), rules), c.write_output()};
      break;
    }
    case pb::Request::kStop:
      to.what = Stop{header.stop().commit(), header.stop().write_output()};
      break;
    case pb::Request::kRefused: {
      const pb::Refused& r = header.refused();
      to.what = Refused{r.where(), r.problem(), r.fix()};
      break;
    }
    case pb::Request::WHAT_NOT_SET:
      rules.broken("asks for nothing that this side knows");
  }
  reader.end();
  return to;
}

Reply decode_reply(const Parts& parts, const std::string& who) {
  Scratch scratch;
  const auto& header = parse_header<pb::Reply>(scratch, parts, {who, "Reply"});
  const Rules rules{who, replies.at(header.what_case())};
  Reader reader(rules, parts);
  Reply to;
  to.sequence = header.sequence();
  to.times = {header.times().received(), header.times().answered()};
  switch (header.what_case()) {
    case pb::Reply::kHello: {
      const pb::Hello& h = header.hello();
      for (const std::string& text : {h.name(), h.solver(), h.version()}) rules.label(text, "name");
      to.what = Hello{h.protocol(), h.name(), h.token(), h.solver(), h.version(), h.case_hash()};
      break;
    }
    case pb::Reply::kReady:
      to.what = read(header.ready(), reader);
      break;
    case pb::Reply::kAdvanced:
      to.what = read(header.advanced(), reader);
      break;
    case pb::Reply::kDone:
      to.what = Done{};
      break;
    case pb::Reply::kFault:
      to.what = read(header.fault());
      break;
    case pb::Reply::kWorking:
      rules.finite(header.working().fraction(), "fraction");
      to.what = Working{header.working().fraction(), header.working().what()};
      break;
    case pb::Reply::WHAT_NOT_SET:
      rules.broken("says nothing that this side knows");
  }
  reader.end();
  return to;
}

// The alternatives stand in the order of their numbers.
const char* name_of(const Request& request) {
  return requests.at(first_number + request.what.index());
}
const char* name_of(const Reply& reply) {
  return replies.at(first_number + reply.what.index());
}

}  // namespace strake::wire
