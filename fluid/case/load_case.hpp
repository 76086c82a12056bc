#pragma once

#include <functional>
#include <string>
#include <vector>

namespace strake {
class CaseFile;
}

namespace strake::fluid {

/// Reads a case file with changes of its keys, and lets `declare` take the fluid's part. Throws
/// Error(case_file).
void load_case(const std::string& case_file, const std::vector<std::string>& sets,
               const std::function<void(CaseFile&)>& declare);

}  // namespace strake::fluid
