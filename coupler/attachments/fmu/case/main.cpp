#include "coupler/attachments/case/attachment_keys.hpp"
#include "coupler/attachments/fmu/fmu_attachment.hpp"
#include "coupler/participant/participant_main.hpp"
#include "proto/case/case_file.hpp"
#include "proto/case/case_keys.hpp"
#include "proto/error.hpp"
#include "proto/version.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

namespace strake {
namespace {

/// The attachments of a case that FMUs compute.
class FmuCase {
 public:
  FmuCase() = default;
  /// Declares and reads the common keys and [[attachments]].
  explicit FmuCase(CaseFile&);
  /// Reads each FMU, and checks what is connected to it; a line for each. No model is instantiated.
  std::vector<std::string> check() const;
  /// Error(command_line) for a name that no attachment with solver = "fmu" has; Error(case_file) for an FMU
  /// that cannot take its state back where windows are computed again.
  std::unique_ptr<FmuAttachment> build(const std::string& name, const Setup&) const;

 private:
  std::vector<AttachmentKeys> fmus_;
  int dimension_ = 2;
  bool is_explicit_ = false;  // one coupling iteration in each window
};

FmuParameters parameters_of(const AttachmentKeys& keys) {
  return {keys.name, keys.fmu.file, keys.fmu.inputs, keys.fmu.outputs, keys.fmu.parameters};
}

FmuCase::FmuCase(CaseFile& file) {
  for (AttachmentKeys& keys : read_attachments(file, read_common(file)))
    if (keys.solver == "fmu") fmus_.push_back(std::move(keys));
  const std::vector<double> dimension = file.numbers_at("fluid.dimension"),
                            iterations = file.numbers_at("coupling.surface.converged.max_iterations");
  if (!dimension.empty()) dimension_ = static_cast<int>(dimension.front());
  is_explicit_ = iterations == std::vector<double>{1};
}

std::vector<std::string> FmuCase::check() const {
  std::vector<std::string> lines;
  for (const AttachmentKeys& keys : fmus_) {
    const FmuPackage package(keys.fmu.file);
    const ModelDescription model = read_model_description(package);
    connect(parameters_of(keys), model, static_cast<Eigen::Index>(keys.at.size()), dimension_);
    package.library(model.model_identifier);
    lines.push_back(
        fmt::format("{}: {}, {} variables", keys.name, visible(model.model, ""), model.variables.size()));
  }
  return lines;
}

std::unique_ptr<FmuAttachment> FmuCase::build(const std::string& name, const Setup& setup) const {
  if (setup.partner_mesh.position.cols() == 0)
    throw Error(ExitCode::command_line, "strake-attachment-fmu",
                "an FMU has no surface, and takes part in runs of Strake alone", "strake run CASE");
  std::vector<std::string> names;
  for (const AttachmentKeys& keys : fmus_) {
    names.push_back(keys.name);
    if (keys.name != name) continue;
    auto fmu = std::make_unique<FmuAttachment>(parameters_of(keys), setup);
    if (!fmu->can_rewind() && !is_explicit_)
      throw Error(ExitCode::case_file, "attachments." + name + ".fmu.file",
                  "the FMU cannot take back its state (canGetAndSetFMUState), and windows are computed again "
                  "until they converge",
                  explicit_coupling);
    return fmu;
  }
  throw Error(ExitCode::command_line, "--name " + name, "is no attachment with solver = \"fmu\"",
              names.empty() ? "the case has none" : "of the case: " + joined(names));
}

}  // namespace
}  // namespace strake

// strake-attachment-fmu: reads [[attachments]], loads the FMU of the one that it is named as, serves the
// coupler.
int main(int argc, char** argv) {
  using namespace strake;
  FmuCase fmus;
  Program program;
  program.program = "strake-attachment-fmu";
  program.solver = "fmu";
  program.version = strake_version();
  program.built_from = build_text();
  program.prefix = "attachments";
  program.declare = [&](CaseFile& file) { fmus = FmuCase(file); };
  program.check = [&](CaseFile&) { return fmus.check(); };
  program.build = [&](CaseFile&, const ParticipantOptions& options, const Setup& setup) {
    return fmus.build(options.name, setup);
  };
  return participant_main(argc, argv, program);
}
