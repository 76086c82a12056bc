#include "coupler/console/console.hpp"
#include "coupler/timing/profile.hpp"
#include "proto/files/json_file.hpp"

#include <nlohmann/json.hpp>

// strake run --json: the lines are described in proto/RESULTS.md.

namespace strake {

namespace {

constexpr double wait_interval = 10;  // [s] between two lines about one answer

class JsonReporter final : public Reporter {
 public:
  explicit JsonReporter(std::FILE* stream) : stream_(stream) {}

  void start(const RunHeader& header) override {
    Json blocks = Json::object(), columns = Json::array();
    for (const auto& [name, lines] : header.blocks) blocks[name] = lines;
    for (const Column& column : header.history)
      columns.push_back({{"name", column.name}, {"unit", column.unit}});
    put({{"kind", "start"},
         {"title", header.title},
         {"folder", header.folder.string()},
         {"time", header.from.time},
         {"end_time", header.end_time},
         {"windows", header.windows},
         {"understood", blocks},
         {"columns", columns}});
    for (const std::string& line : header.warnings) warning(line);
  }

  void window(const RunRow& row) override {
    const CommittedWindow& window = *row.window;
    if (!window.output && !window.last && window.number != 1) return;
    Json line = {{"kind", "window"},
                 {"window", window.number},
                 {"time", window.time},
                 {"iterations", window.report.iterations},
                 {"residual", finite(window.report.residual)},
                 {"converged", window.report.converged},
                 {"elapsed", row.elapsed}};
    Json values = Json::object();
    if (row.history != nullptr)
      for (std::size_t k = 0; k < row.history->columns.size(); ++k)
        values[row.history->columns[k].name] = finite(row.history->value[k].back());
    line["values"] = values;
    put(line);
  }

  void wait(const Awaited& whom, double elapsed) override {
    if (whom.waited < wait_interval || elapsed < last_wait_ + wait_interval) return;
    last_wait_ = elapsed;
    put({{"kind", "waiting"},
         {"participant", whom.name},
         {"asked", whom.asked},
         {"seconds", whom.waited},
         {"doing", whom.doing},
         {"part", whom.doing.empty() ? Json(nullptr) : finite(whom.part)}});
  }

  void verdict(const Verdict& verdict) override {
    put({{"kind", "verdict"}, {"line", verdict.line()}, {"verdict", json_of(verdict)}});
  }
  void note(const std::string& line) override { put({{"kind", "note"}, {"text", line}}); }
  void alarm(const std::string& line) override { put({{"kind", "alarm"}, {"text", line}}); }
  void warning(const std::string& line) override { put({{"kind", "warning"}, {"text", line}}); }
  void error(const Error& error) override {
    put({{"kind", "error"},
         {"where", error.where()},
         {"problem", error.problem()},
         {"fix", error.fix()},
         {"exit_code", static_cast<int>(error.code())}});
  }
  void end(const RunEnd& end) override {
    if (end.profile != nullptr) put({{"kind", "profile"}, {"seconds", end.profile->json()}});
    put({{"kind", "end"},
         {"exit_code", static_cast<int>(end.summary->exit_code)},
         {"folder", end.folder.string()},
         {"fields", end.fields},
         {"summary", end.summary->json()}});
  }

 private:
  void put(const Json& line) {
    // In ASCII, so that no control character of a text reaches a terminal.
    strake::put(stream_, json_text(line, -1, true) + "\n");
  }
  std::FILE* stream_;
  double last_wait_ = -wait_interval;  // [s]
};

}  // namespace

std::unique_ptr<Reporter> json_reporter(std::FILE* stream) {
  return std::make_unique<JsonReporter>(stream);
}

}  // namespace strake
