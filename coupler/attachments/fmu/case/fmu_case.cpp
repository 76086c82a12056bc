#include "coupler/attachments/fmu/case/fmu_case.hpp"

#include "proto/case/case_file.hpp"
#include "proto/case/case_keys.hpp"
#include "proto/error.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

namespace strake {
namespace {

FmuParameters parameters_of(const AttachmentKeys& keys) {
  return {keys.name, keys.fmu.file, keys.fmu.inputs, keys.fmu.outputs, keys.fmu.parameters};
}

}  // namespace

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

}  // namespace strake
