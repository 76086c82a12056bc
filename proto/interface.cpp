#include "proto/interface.hpp"

namespace strake {

const Field* find(const std::vector<Field>& fields, const std::string& quantity) {
  for (const Field& field : fields)
    if (field.quantity == quantity) return &field;
  return nullptr;
}

}  // namespace strake
