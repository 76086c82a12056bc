#include "coupler/watch/web/http_api.hpp"

#include "coupler/plot/canvas.hpp"
#include "coupler/plot/scene.hpp"
#include "coupler/watch/select_run.hpp"
#include "coupler/watch/web/field_view.hpp"
#include "proto/error.hpp"
#include "proto/files/json_file.hpp"
#include "proto/lookup.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace strake::watch {
namespace {

constexpr std::chrono::milliseconds between_updates{200};  // however many pages ask
constexpr std::size_t most_rows = 20'000;                  // of a table in one answer
constexpr std::int64_t most_log = 64 << 10;                // [bytes] of a log in one answer
constexpr int colours = 64;                                // of a palette

HttpApi::Answer json_answer(const Json& json) {
  return {200, "application/json", json_text(json)};
}

HttpApi::Answer refusal(int status, const std::string& sentence) {
  return {status, "text/plain; charset=utf-8", sentence + "\n"};
}

/// A request of another form than http_api.hpp describes.
Error wrong(const std::string& key, const std::string& value, const std::string& expected) {
  return {ExitCode::command_line, fmt::format("{}={}", key, value), "expected " + expected};
}

std::int64_t integer(const HttpApi::Query& query, const std::string& key, std::int64_t least) {
  const std::string value = at_or(query, key);
  const auto number = number_from<std::int64_t>(value);
  if (!number || *number < least) throw wrong(key, value, fmt::format("a whole number, at least {}", least));
  return *number;
}

std::string one_of(const HttpApi::Query& query, const std::string& key,
                   const std::vector<std::string>& known) {
  const std::string value = at_or(query, key);
  std::string list;
  for (const std::string& name : known) {
    if (value == name) return value;
    list += (list.empty() ? "" : " or ") + name;
  }
  throw wrong(key, value, list);
}

/// Logs of a run: the coupler's, and one of each participant.
std::vector<std::string> log_names(const WatchedRun& run) {
  std::vector<std::string> names = {"coupler"};
  if (const Json& sides = member(run.record(), "participants"); sides.is_object())
    for (const auto& [side, participant] : sides.items())
      if (side.find_first_of("/.") == std::string::npos) names.push_back(side);
  if (names.size() == 1) names.insert(names.end(), {"fluid", "structure"});
  return names;
}

/// Red, green, blue from 0 to 255, from the least value to the largest.
template <typename Map>
Json palette(Map map) {
  Json all = Json::array();
  for (int k = 0; k < colours; ++k) {
    const picture::Colour colour = map(k / (colours - 1.0));
    for (const double c : {colour.red, colour.green, colour.blue}) all.push_back(std::lround(255 * c));
  }
  return all;
}

}  // namespace

HttpApi::HttpApi(const std::filesystem::path& run_folder) : run_(run_folder), frames_(run_folder) {}

void HttpApi::update() {
  const auto now = std::chrono::steady_clock::now();
  if (updated_.time_since_epoch().count() != 0 && now - updated_ < between_updates) return;
  updated_ = now;
  run_.update();
  const std::lock_guard alone(frames_mutex_);
  frames_.update();
}

HttpApi::Answer HttpApi::answer(const std::string& path, const Query& query) {
  try {
    for (const PageFile& file : page_files())
      if (file.name == path) return {200, std::string(file.type), std::string(file.bytes)};
    if (path == "api/run") return run();
    if (path == "api/news") return news();
    if (path == "api/table") return table(query);
    if (path == "api/frames") return frames(query);
    if (path == "api/frame") return frame(query);
    if (path == "api/point") return point(query);
    if (path == "api/log") return log(query);
    return refusal(404, "there is no such page");
  } catch (const Error& error) {
    // What a run no longer has is news for the page, not a fault.
    return refusal(error.code() == ExitCode::command_line ? 400 : 404,
                   error.where() + ": " + error.problem());
  } catch (const std::exception& error) {
    return refusal(500, error.what());
  }
}

HttpApi::Answer HttpApi::run() {
  const std::lock_guard alone(run_mutex_);
  update();
  const Json& record = run_.record();
  Json sides = Json::object();
  if (const Json& participants = member(record, "participants"); participants.is_object())
    for (const auto& [side, program] : participants.items()) sides[side] = string_of(program, "solver");
  const int dimension = static_cast<int>(run_.number("fluid.dimension").value_or(2));
  double solid_spacing = run_.number("structure.particle.spacing").value_or(0);
  const double spacing = run_.number("fluid.spacing").value_or(0);
  if (solid_spacing == 0 && string_of(sides, "structure") == "particle") {
    const std::lock_guard frames_alone(frames_mutex_);
    if (!frames_.series("structure").entries.empty())
      solid_spacing = picture::lattice_spacing(*frames_.read("structure", 0));
  }
  if (spacing > 0 && (solid_spacing == 0 || at_or(run_.keys(), "coupling.interface") == "volume"))
    solid_spacing = spacing;
  return json_answer(
      {{"title", run_.title()},
       {"name", run_.name()},
       {"folder", std::filesystem::absolute(run_.folder()).lexically_normal().string()},
       {"version", string_of(record, "strake")},
       {"host", string_of(record, "host")},
       {"known", !run_.keys().empty()},
       {"dimension", dimension},
       {"spacing", spacing},
       {"solid_spacing", solid_spacing},
       {"sides", sides},
       {"probes", run_.probes()},
       {"palette", {{"water", palette(picture::water_colour)}, {"solid", palette(picture::solid_colour)}}}});
}

HttpApi::Answer HttpApi::news() {
  const std::lock_guard alone(run_mutex_);
  update();
  const RunStatus& g = run_.last();
  Json json = {{"state", name_of(g.state)},
               {"open", open(g.state)},
               {"words", g.words},
               {"error", g.error},
               {"exit_code", g.exit_code ? Json(*g.exit_code) : Json()},
               {"time", g.time},
               {"end_time", finite(g.end_time)},
               {"window", g.window},
               {"elapsed", g.elapsed},
               {"left", finite(g.left)},
               {"silence", g.silence}};
  json["processes"] = Json::array();
  for (const Process& p : g.processes)
    json["processes"].push_back({{"name", p.name},
                                 {"pid", p.pid},
                                 {"state", words_for_state(p.state)},
                                 {"cpu_seconds", p.cpu_seconds},
                                 {"memory", p.memory_bytes}});
  json["stages"] = Json::array();
  for (const Stage& stage : stages(run_))
    json["stages"].push_back({{"name", stage.name}, {"seconds", stage.seconds}});
  for (const auto& [name, table] :
       {std::pair("history", &run_.history()), std::pair("iterations", &run_.iterations())})
    json["tables"][name] = {{"rows", table->rows()}, {"generation", table->generation()}};
  for (const std::string& name : log_names(run_)) {
    std::error_code error;
    const auto size = std::filesystem::file_size(run_.folder() / fmt::format("{}.log", name), error);
    if (!error) json["logs"][name] = size;
  }
  const std::lock_guard frames_alone(frames_mutex_);
  for (const char* side : {"fluid", "structure"}) {
    const auto& series = frames_.series(side);
    json["frames"][side] = {{"count", series.entries.size()}, {"generation", series.generation}};
  }
  return json_answer(json);
}

HttpApi::Answer HttpApi::table(const Query& query) {
  const std::string name = one_of(query, "name", {"history", "iterations", "timing"});
  const auto from = static_cast<std::size_t>(integer(query, "from", 0));
  const std::lock_guard alone(run_mutex_);
  update();
  const TableTail& table = name == "history"      ? run_.history()
                           : name == "iterations" ? run_.iterations()
                                                  : run_.timing();
  const std::size_t begin = std::min(from, table.rows()), rows = std::min(most_rows, table.rows() - begin);
  ArrayMessage message;
  message.head["generation"] = table.generation();
  message.head["rows"] = table.rows();
  message.head["from"] = begin;
  message.head["columns"] = Json::array();
  for (const Column& column : table.columns())
    message.head["columns"].push_back(
        {{"name", column.name}, {"unit", column.unit}, {"logarithmic", is_logarithmic(column.name)}});
  if (name == "history") message.head["chosen"] = chosen_columns(run_, 6);
  for (std::size_t c = 0; c < table.columns().size(); ++c)
    message.add(std::to_string(c), std::span(table.value()[c]).subspan(begin, rows));
  return {200, "application/octet-stream", message.bytes()};
}

HttpApi::Answer HttpApi::frames(const Query& query) {
  const std::string side = one_of(query, "side", {"fluid", "structure"});
  const auto from = static_cast<std::size_t>(integer(query, "from", 0));
  const std::lock_guard alone(run_mutex_);
  update();
  const std::lock_guard frames_alone(frames_mutex_);
  const FrameCache::Series& series = frames_.series(side);
  Json numbers = Json::array(), times = Json::array();
  for (std::size_t k = from; k < series.entries.size(); ++k) {
    numbers.push_back(series.entries[k].number);
    times.push_back(series.entries[k].time);
  }
  return json_answer(
      {{"generation", series.generation}, {"from", from}, {"numbers", numbers}, {"times", times}});
}

HttpApi::Answer HttpApi::frame(const Query& query) {
  FieldRequest request;
  request.side = one_of(query, "side", {"fluid", "structure"});
  request.field = at_or(query, "field");
  const auto number = static_cast<int>(std::min<std::int64_t>(integer(query, "number", 0), 1'000'000'000));
  {
    const std::lock_guard alone(run_mutex_);
    request.keys = run_.keys();
    request.dimension = static_cast<int>(run_.number("fluid.dimension").value_or(2));
  }
  std::shared_ptr<const Frame> frame;
  {
    const std::lock_guard alone(frames_mutex_);
    frame = frames_.read(request.side, number);
    request.parts = frames_.parts();
  }
  return {200, "application/octet-stream", field_message(*frame, request).bytes()};
}

HttpApi::Answer HttpApi::point(const Query& query) {
  const std::string side = one_of(query, "side", {"fluid", "structure"});
  const auto number = static_cast<int>(std::min<std::int64_t>(integer(query, "number", 0), 1'000'000'000));
  const bool by_id = query.contains("id");
  const std::int64_t wanted = integer(query, by_id ? "id" : "index", 0);
  std::shared_ptr<const Frame> frame;
  {
    const std::lock_guard alone(frames_mutex_);
    frame = frames_.read(side, number);
  }
  return json_answer(point_values(*frame, by_id ? place_of(*frame, wanted) : wanted));
}

HttpApi::Answer HttpApi::log(const Query& query) {
  std::vector<std::string> names;
  {
    const std::lock_guard alone(run_mutex_);
    names = log_names(run_);
  }
  const std::string name = one_of(query, "name", names);
  const std::int64_t wanted = integer(query, "from", -1);
  std::ifstream file(run_.folder() / (name + ".log"), std::ios::binary | std::ios::ate);
  const std::int64_t size = file ? static_cast<std::int64_t>(file.tellg()) : 0;
  // A log that is shorter than what was read of it is another one.
  std::int64_t from = wanted < 0 || wanted > size ? std::max<std::int64_t>(0, size - most_log) : wanted;
  if (size - from > most_log) from = size - most_log;
  std::string bytes(static_cast<std::size_t>(size - from), '\0');
  file.seekg(from);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, file.gcount())));
  // Whole lines alone: the rest comes with the next question.
  const auto end = bytes.rfind('\n');
  bytes.resize(end == std::string::npos ? 0 : end + 1);
  if (wanted < 0 && from > 0) {
    const auto first = bytes.find('\n');
    if (first != std::string::npos) {
      from += static_cast<std::int64_t>(first + 1);
      bytes.erase(0, first + 1);
    }
  }
  return json_answer({{"from", from},
                      {"to", from + static_cast<std::int64_t>(bytes.size())},
                      {"begins", from != wanted},
                      {"text", bytes}});
}

}  // namespace strake::watch
