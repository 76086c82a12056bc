#include "fluid/case/load_case.hpp"

#include "proto/case/case_file.hpp"

namespace strake::fluid {

void load_case(const std::string& case_file, const std::vector<std::string>& sets,
               const std::function<void(CaseFile&)>& declare) {
  CaseFile file = CaseFile::load(case_file, sets);
  file.read_all([&] { declare(file); });
}

}  // namespace strake::fluid
