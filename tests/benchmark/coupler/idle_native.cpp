// A participant of STRAKE_POINTS points that computes nothing: it returns what it received plus one. It speaks to
// the coupler by Strake's own library (library_overhead.py).
#include "coupler/participant/serve.hpp"

#include <cstdlib>
#include <string>

namespace {

using namespace strake;

class Idle final : public Participant {
 public:
  Idle(const std::string& name, Eigen::Index n) : fluid_(name == "fluid") {
    mesh_ = {name, 2, Points::Zero(3, n), Eigen::MatrixXi(2, n - 1), {}};
    mesh_.position.row(0).setLinSpaced(n, 0, 1);
    for (int k = 0; k + 1 < n; ++k) mesh_.faces.col(k) << k, k + 1;
    description_.initial = fields(Points::Zero(3, n));
  }
  const InterfaceMesh& mesh() const override { return mesh_; }
  const Description& description() const override { return description_; }
  void start(const Window&, const Input& input) override {
    answer_ = input.samples.back().fields.front().value.array() + 1;
  }
  Advanced finish() override {
    Advanced advanced;
    advanced.output = fields(answer_);
    return advanced;
  }
  void rewind() override {}
  void commit(bool) override {}
  void checkpoint(const std::filesystem::path&) override {}
  void resume(const std::filesystem::path&) override {}

 private:
  std::vector<Field> fields(const Points& value) const {
    return {{fluid_ ? "force" : "displacement", fluid_ ? "N" : "m", fluid_, value}};
  }
  bool fluid_;
  InterfaceMesh mesh_;
  Description description_;
  Points answer_;
};

}  // namespace

int main(int argc, char** argv) {
  ServeOptions options;
  options.solver = "idle";
  options.version = "1";
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string key = argv[i], value = argv[i + 1];
    if (key == "--connect") options.endpoint = value;
    if (key == "--name") options.name = value;
    if (key == "--case-hash")
      for (std::size_t k = 0; k < options.case_hash.size(); ++k)
        options.case_hash[k] = static_cast<std::uint8_t>(std::stoi(value.substr(2 * k, 2), nullptr, 16));
  }
  const char *token = std::getenv("STRAKE_TOKEN"), *points = std::getenv("STRAKE_POINTS");
  options.token = token ? token : "";
  const long n = points ? std::atol(points) : 41;
  return serve(options, [&](const Setup&) { return std::make_unique<Idle>(options.name, n); });
}
