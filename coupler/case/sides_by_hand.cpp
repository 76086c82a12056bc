#include "coupler/case/sides_by_hand.hpp"

#include "coupler/case/case_view.hpp"
#include "proto/error.hpp"

#include <algorithm>

namespace strake {

bool starts_by_hand(const std::vector<std::string>& by_hand, const SideView& side) {
  return std::any_of(by_hand.begin(), by_hand.end(), [&](const std::string& name) {
    return name == side.side || (side.is_body && name == "structure");
  });
}

void check_by_hand(const std::vector<std::string>& by_hand, const CaseView& view) {
  const std::vector<const SideView*> sides = view.sides();
  for (const std::string& name : by_hand) {
    const auto is_meant = [&](const SideView* side) { return starts_by_hand({name}, *side); };
    const auto is_program = [&](const AttachmentKeys& one) { return one.name == name && one.is_program(); };
    if (std::any_of(sides.begin(), sides.end(), is_meant) ||
        std::any_of(view.attachments.begin(), view.attachments.end(), is_program))
      continue;
    throw Error(ExitCode::command_line, "--attach", "the case has no " + name,
                "--attach names sides and attachments that a program computes");
  }
}

}  // namespace strake
