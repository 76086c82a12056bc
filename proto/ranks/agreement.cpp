#include "proto/ranks/agreement.hpp"

#include "proto/ranks/error_message.hpp"

#include <algorithm>
#include <optional>

namespace strake {

void on_all_ranks(Communicator& ranks, const std::function<void()>& todo) {
  std::optional<Error> own = error_of(todo);
  if (!ranks.any(own.has_value())) return;
  if (own && own->where().empty()) own = of_rank(ranks.rank(), *own);
  const std::vector<Bytes> all = ranks.gather(packed(own));
  throw unpacked(*std::ranges::find_if(all, [](const Bytes& bytes) { return !bytes.empty(); }));
}

void on_first_rank(Communicator& ranks, const std::function<void()>& todo) {
  on_all_ranks(ranks, [&] {
    if (ranks.rank() == 0) todo();
  });
}

std::vector<FilePart> parts_of_all(Communicator& ranks, const FilePart& own) {
  Bytes bytes;
  append(bytes, own.length);
  append(bytes, own.bytes);
  append_text(bytes, own.file);
  std::vector<FilePart> parts;
  for (const Bytes& one : ranks.gather(bytes)) {
    const std::byte* at = one.data();
    FilePart& part = parts.emplace_back();
    part.length = take<std::int64_t>(at);
    part.bytes = take<std::int64_t>(at);
    part.file = take_text(at);
  }
  return parts;
}

}  // namespace strake
