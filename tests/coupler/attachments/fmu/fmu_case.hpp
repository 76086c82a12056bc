#pragma once

#include "coupler/attachments/fmu/fmu_attachment.hpp"
#include "proto/error.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>

namespace strake {

/// The FMU of the tests, packed and as a folder.
inline const std::filesystem::path test_fmus = STRAKE_TEST_FMU;
inline const std::filesystem::path packed_fmu = test_fmus / "oscillator.fmu";
inline const std::filesystem::path fmu_folder = test_fmus / "oscillator";

/// A folder of the test's own, removed at its end.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "fmu-test-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~ScratchFolder() { std::filesystem::remove_all(path_); }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

/// A copy of the oscillator's folder in which one text of its description is another.
inline std::filesystem::path changed_fmu(const ScratchFolder& scratch, const std::string& from,
                                         const std::string& to) {
  const std::filesystem::path folder = scratch / "changed";
  std::filesystem::copy(fmu_folder, folder, std::filesystem::copy_options::recursive);
  std::string text = text_of(folder / "modelDescription.xml");
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  if (at != std::string::npos) text.replace(at, from.size(), to);
  std::ofstream(folder / "modelDescription.xml", std::ios::binary) << text;
  return folder;
}

inline FmuParameters oscillator_of(const std::vector<std::string>& parameters = {}) {
  return {.name = "damper",
          .file = fmu_folder,
          .inputs = {"end.u = displacement.y", "end.w = velocity.y"},
          .outputs = {"force.y = force"},
          .parameters = parameters};
}

/// k points at rest, apart by 1 m.
inline Setup setup_of(Eigen::Index k = 1, int dimension = 2) {
  Setup setup;
  setup.partner_mesh.dimension = dimension;
  setup.partner_mesh.position = Points::Zero(3, k);
  setup.partner_mesh.position.row(0).setLinSpaced(k, 0, static_cast<double>(k - 1));
  setup.partner_mesh.faces.resize(dimension, 0);
  const Eigen::MatrixXd rest = Eigen::MatrixXd::Zero(3, k);
  setup.partner_initial = {{"displacement", "m", false, rest}, {"velocity", "m/s", false, rest}};
  return setup;
}

/// Motion of all points in y at the end of a window.
inline Input motion_to(const FmuAttachment& fmu, double time, double displacement, double velocity) {
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(3, fmu.mesh().position.cols()), v = u;
  u.row(1).setConstant(displacement);
  v.row(1).setConstant(velocity);
  Input input;
  input.samples = {{time, {{"displacement", "m", false, u}, {"velocity", "m/s", false, v}}}};
  return input;
}

inline double force_of(const Advanced& answer) {
  return answer.output.at(0).value(1, 0);
}

/// The text of the error that `run` throws; empty without one.
inline std::string error_of(const std::function<void()>& run, ExitCode code) {
  try {
    run();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << to_text(error);
    return to_text(error);
  }
  return {};
}

}  // namespace strake
