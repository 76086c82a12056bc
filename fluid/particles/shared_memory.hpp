#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

namespace strake::fluid {

/// Memory for stages of a step that run one after the other. A stage keeps nothing in it for the next: each
/// makes its own objects where the last one's were.
class SharedMemory {
 public:
  template <class T>
  std::span<T> of(std::size_t n) {
    static_assert(std::is_trivially_destructible_v<T> && alignof(T) <= alignof(Block));
    blocks_.resize((n * sizeof(T) + sizeof(Block) - 1) / sizeof(Block));
    auto* const first = reinterpret_cast<T*>(blocks_.data());
    std::uninitialized_default_construct_n(first, n);
    return {first, n};
  }
  void swap(SharedMemory& other) { blocks_.swap(other.blocks_); }
  std::size_t bytes() const { return sizeof(Block) * blocks_.capacity(); }

 private:
  struct alignas(64) Block {
    std::byte bytes[64];
  };
  std::vector<Block> blocks_;
};

}  // namespace strake::fluid
