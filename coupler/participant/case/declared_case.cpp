#include "coupler/participant/case/declared_case.hpp"

#include "proto/error.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

namespace strake {

void require_option(bool condition, const std::string& option) {
  if (!condition)
    throw Error(ExitCode::command_line, option, "is missing",
                "strake starts this program itself: strake run CASE; --help lists the modes");
}

void declare_case(CaseFile& file, const Program& program) {
  file.read_all([&] {
    program.declare(file);
    file.refuse_unknown(program.prefix);
  });
  if (program.sizes) refuse_oversized(file, program.sizes());
}

CaseFile load_case(const ParticipantOptions& options, const Program& program) {
  CaseFile file = CaseFile::load(options.case_file, options.sets);
  if (!options.body.empty()) return file.of_body(options.body);
  if (program.prefix == "structure" && !file.bodies().empty())
    throw Error(ExitCode::command_line, "--body",
                fmt::format("is missing: the case has the bodies {}", joined(file.bodies())),
                "--body " + file.bodies().front());
  return file;
}

CaseFile load_declared(const ParticipantOptions& options, const Program& program) {
  require_option(!options.case_file.empty(), "--case");
  CaseFile file = load_case(options, program);
  declare_case(file, program);
  return file;
}

}  // namespace strake
