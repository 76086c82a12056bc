#pragma once

#include "coupler/attachments/case/attachment_keys.hpp"
#include "coupler/attachments/fmu/fmu_attachment.hpp"

#include <memory>
#include <string>
#include <vector>

namespace strake {

class CaseFile;

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

}  // namespace strake
