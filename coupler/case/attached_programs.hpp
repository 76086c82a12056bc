#pragma once

#include "coupler/attachments/case/attachment_keys.hpp"
#include "coupler/case/case_view.hpp"
#include "proto/files/json_file.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace strake {

/// The program of an attachment that is computed by one. Throws Error where it is not there.
std::filesystem::path program_of(const AttachmentKeys&, const CaseView&);

/// Refuses an attachment whose program is not there. by_hand: sides that the user starts.
void check_attached_programs(const CaseView&, const std::vector<std::string>& by_hand);

/// Adds solver and program of each attachment that is a program, under its name, as run.json has them.
/// Returns those that the coupler computes itself.
Json record_attachments(const CaseView&, Json& programs);

}  // namespace strake
