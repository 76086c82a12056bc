#include "coupler/case/case_queries.hpp"

#include "coupler/attachments/case/attachment_keys.hpp"
#include "coupler/case/coupling_keys.hpp"
#include "coupler/compare/compare_block.hpp"
#include "proto/case/case_file.hpp"

namespace strake {

CommonKeys common_keys_of(const std::filesystem::path& case_file, const std::vector<std::string>& sets) {
  CaseFile file = CaseFile::load(case_file, sets);
  return read_common(file);
}

std::vector<CompareBlock> compare_blocks_of(const std::filesystem::path& case_file) {
  CaseFile file = CaseFile::load(case_file);
  return read_compare_blocks(file);
}

std::array<std::uint8_t, 32> case_hash(const std::filesystem::path& case_file,
                                       const std::vector<std::string>& sets) {
  return CaseFile::load(case_file, sets).hash();
}

std::vector<std::string> given_among(const std::vector<std::string>& keys,
                                     const std::filesystem::path& case_file,
                                     const std::vector<std::string>& sets) {
  const CaseFile file = CaseFile::load(case_file, sets);
  std::vector<std::string> given;
  for (const std::string& key : keys)
    if (file.has(key)) given.push_back(key);
  return given;
}

std::vector<KeyInfo> coupler_declarations() {
  CaseFile file = CaseFile::declarations_only();
  const CommonKeys common = read_common(file);
  read_coupling(file);
  read_compare_blocks(file);
  read_attachments(file, common);
  return file.declared();
}

}  // namespace strake
