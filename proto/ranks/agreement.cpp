#include "proto/ranks/agreement.hpp"

#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <optional>
#include <string>

namespace strake {
namespace {

void append(Bytes& bytes, const std::string& text) {
  strake::append(bytes, text.size());
  const auto* const from = reinterpret_cast<const std::byte*>(text.data());
  bytes.insert(bytes.end(), from, from + text.size());
}

std::string take_text(const std::byte*& at) {
  const auto size = take<std::size_t>(at);
  std::string text(reinterpret_cast<const char*>(at), size);
  at += size;
  return text;
}

Bytes packed(const Error& error) {
  Bytes bytes;
  strake::append(bytes, error.code());
  for (const std::string& text : {error.where(), error.problem(), error.fix()}) append(bytes, text);
  return bytes;
}

Error unpacked(const Bytes& bytes) {
  const std::byte* at = bytes.data();
  const auto code = take<ExitCode>(at);
  const std::string where = take_text(at), problem = take_text(at), fix = take_text(at);
  return {code, where, problem, fix};
}

std::optional<Error> error_of(const Communicator& ranks, const std::function<void()>& todo) {
  const std::string rank = fmt::format("rank {}", ranks.rank());
  try {
    todo();
  } catch (const Error& error) {
    return error;
  } catch (const std::bad_alloc&) {
    return Error(ExitCode::solver_fault, rank, "is out of memory",
                 "a coarser spacing or more ranks need less");
  } catch (const std::exception& error) {
    return Error(ExitCode::our_bug, rank, fmt::format("unexpected: {}", error.what()), "please report it");
  }
  return std::nullopt;
}

}  // namespace

void on_all_ranks(Communicator& ranks, const std::function<void()>& todo) {
  const std::optional<Error> own = error_of(ranks, todo);
  if (!ranks.any(own.has_value())) return;
  const std::vector<Bytes> all = ranks.gather(own ? packed(*own) : Bytes{});
  throw unpacked(*std::ranges::find_if(all, [](const Bytes& bytes) { return !bytes.empty(); }));
}

void on_first_rank(Communicator& ranks, const std::function<void()>& todo) {
  on_all_ranks(ranks, [&] {
    if (ranks.rank() == 0) todo();
  });
}

std::vector<FilePart> parts_of_all(Communicator& ranks, const FilePart& own) {
  Bytes bytes;
  strake::append(bytes, own.length);
  strake::append(bytes, own.bytes);
  append(bytes, own.file);
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
