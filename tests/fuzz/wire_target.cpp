// What arrives from the network: a message of any parts must be read, or refused with an Error.
//
// Bytes → parts: the first byte is even for a request, odd for a reply; then each part is its length (two
// bytes, the least first) and that many bytes, the last one what is left.

#include "proto/error.hpp"
#include "proto/wire/wire.hpp"
#include "tests/fuzz/fuzz.hpp"

#include <algorithm>
#include <cstdlib>
#include <span>
#include <type_traits>

namespace {

using namespace strake;

wire::Parts parts_of(std::span<const std::byte> bytes) {
  wire::Parts parts;
  while (!bytes.empty()) {
    std::size_t n = std::to_integer<std::size_t>(bytes[0]);
    if (bytes.size() > 1) n += 256 * std::to_integer<std::size_t>(bytes[1]);
    bytes = bytes.subspan(std::min<std::size_t>(2, bytes.size()));
    n = std::min(n, bytes.size());
    parts.push_back({bytes.first(n), nullptr});
    bytes = bytes.subspan(n);
  }
  return parts;
}

std::string flat(const wire::Parts& parts, char kind) {
  std::string bytes(1, kind);
  for (const wire::Part& part : parts) {
    const std::size_t n = part.bytes.size();
    bytes += static_cast<char>(n % 256);
    bytes += static_cast<char>(n / 256);
    bytes.append(reinterpret_cast<const char*>(part.bytes.data()), n);
  }
  return bytes;
}

/// What was understood can be said again, and is understood in the same way. The names of a map may come in
/// another order, so that of the header the size counts.
template <class Message>
void repeat(Message message, Message (*decode)(const wire::Parts&, const std::string&)) {
  const wire::Parts once = wire::encode(std::move(message), "fuzz");
  const wire::Parts twice = wire::encode(decode(once, "fuzz"), "fuzz");
  if (once.size() != twice.size()) std::abort();
  for (std::size_t i = 0; i < once.size(); ++i) {
    if (once[i].bytes.size() != twice[i].bytes.size()) std::abort();
    if (i > 0 && !std::equal(once[i].bytes.begin(), once[i].bytes.end(), twice[i].bytes.begin()))
      std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const wire::Parts parts = parts_of(std::as_bytes(std::span(data, size)).subspan(1));
  try {
    if (data[0] % 2 == 0) {
      wire::Request request = wire::decode_request(parts);
      repeat(std::move(request), &wire::decode_request);
    } else {
      wire::Reply reply = wire::decode_reply(parts, "fuzz");
      repeat(std::move(reply), &wire::decode_reply);
    }
  } catch (const Error& error) {
    if (error.problem().empty() || error.problem().size() > 4096)
      std::abort();  // every refusal says why, briefly
  }
  return 0;
}

std::vector<std::string> seeds() {
  InterfaceMesh mesh{"plate", 2, Points::Ones(3, 3), Eigen::MatrixXi(2, 2), Eigen::VectorXd::Ones(3)};
  mesh.faces << 0, 1, 1, 2;
  InterfaceMesh hull{"hull", 3, Points::Ones(3, 4), Eigen::MatrixXi(3, 1), {}};
  hull.faces << 0, 1, 2;
  const Field force{"force", "N", true, Points::Constant(3, 3, 2.5)};
  const Field area{"area", "m^2", false, Eigen::MatrixXd::Constant(1, 5, 0.1)};
  std::vector<std::string> all;
  const auto request = [&](auto what) {
    all.push_back(flat(wire::encode(wire::Request{7, std::move(what)}), 0));
  };
  const auto reply = [&](auto what) {
    all.push_back(flat(wire::encode(wire::Reply{7, std::move(what)}, "fluid"), 1));
  };
  Setup setup;
  setup.run_folder = "/runs/plate";
  setup.interface = "surface";
  setup.partner_mesh = mesh;
  setup.partner_initial = {force, area};
  request(setup);
  setup.partner_mesh = hull;
  request(setup);
  wire::Advance advance;
  advance.window = {0.5, 0.25};
  request(advance);
  advance.before = wire::Before::commit;
  advance.write_output = true;
  advance.input.samples = {{0.5, {force}}, {0.75, {force, area}}};
  request(advance);
  request(wire::Checkpoint{"/runs/plate/checkpoint/000042", true, wire::Before::rewind, false});
  request(wire::Stop{true, true});
  request(wire::Refused{"coupler", "another case", "give it the same --case"});
  reply(wire::Hello{1, "fluid", std::string(16, 't'), "mps", "0.1", std::string(32, 'h')});
  Description description;
  description.initial = {force};
  description.columns = {{"mid.y", "m"}};
  description.lines = {"headline"};
  reply(wire::Ready{mesh, description});
  wire::Ready joined{mesh, description};
  joined.mesh.faces.resize(0, 0);
  joined.mesh.meshes = {{"nodes", 0, 0}, {"faces", 1, 0}};
  joined.description.sent_on = {{"force", "faces"}};
  joined.description.taken_on = {{"displacement", "nodes"}};
  reply(joined);
  Advanced advanced;
  advanced.output = {force, area};
  advanced.dt_limit = 1e-3;
  advanced.monitor = {{"cfl", 0.2}, {"p_mid", 1e5}};
  reply(advanced);
  advanced.retry_smaller_dt = true;
  advanced.output.clear();
  reply(advanced);
  reply(wire::Done{});
  reply(wire::Fault{"fluid", "did not converge", "a smaller step", ExitCode::solver_fault});
  reply(wire::Working{0.5, "factorising"});
  return all;
}
