#include "coupler/case/attached_programs.hpp"

#include "coupler/participant/launch.hpp"
#include "proto/error.hpp"

#include <algorithm>

namespace strake {

std::filesystem::path program_of(const AttachmentKeys& attachment, const CaseView& view) {
  return find_program(attachment.is_users() ? attachment.solver : "strake-attachment-" + attachment.solver,
                      view.folder);
}

void check_attached_programs(const CaseView& view, const std::vector<std::string>& by_hand) {
  for (const AttachmentKeys& one : view.attachments) {
    if (!one.is_program() || std::find(by_hand.begin(), by_hand.end(), one.name) != by_hand.end()) continue;
    std::error_code ignored;
    if (one.is_users() && !std::filesystem::is_regular_file(one.solver, ignored))
      throw Error(ExitCode::case_file, view.path.string() + ": attachments." + one.name + ".solver",
                  "there is no file " + one.solver, "the path of a program");
    program_of(one, view);
  }
}

Json record_attachments(const CaseView& view, Json& programs) {
  Json lines = Json::object();
  for (const AttachmentKeys& one : view.attachments)
    if (one.is_program())
      programs[one.name] = {{"solver", one.solver},
                            {"program", one.is_users() ? one.solver : program_of(one, view).string()}};
    else
      lines[one.name] = {{"solver", one.solver}};
  return lines;
}

}  // namespace strake
