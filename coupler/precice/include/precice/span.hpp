#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

namespace precice {

/// Stands for a number of elements that is known only at run time.
constexpr std::size_t dynamic_extent = SIZE_MAX;

template <typename Element, std::size_t extent>
class span;

namespace detail {

template <typename T>
struct is_span : std::false_type {};
template <typename T, std::size_t n>
struct is_span<span<T, n>> : std::true_type {};

/// True if elements of type From may be seen as To. That is the same type, or To adds const.
template <typename From, typename To>
using may_view = std::is_convertible<From (*)[], To (*)[]>;

/// Enabled for a container with data() and size() whose elements may be seen as To.
template <typename Container, typename To>
using if_container = typename std::enable_if<
    !is_span<typename std::decay<Container>::type>::value &&
    std::is_convertible<decltype(std::declval<Container&>().size()), std::size_t>::value &&
    may_view<typename std::remove_pointer<decltype(std::declval<Container&>().data())>::type,
             To>::value>::type;

}  // namespace detail

/// A view of elements that lie in a row in memory of somebody else's. Copies are as cheap as a pointer and a
/// number.
template <typename Element, std::size_t extent = dynamic_extent>
class span {
 public:
  using element_type = Element;
  using value_type = typename std::remove_cv<Element>::type;
  using size_type = std::size_t;
  using iterator = Element*;

  constexpr span() noexcept : data_(nullptr), size_(0) {}
  constexpr span(Element* first, std::size_t size) noexcept : data_(first), size_(size) {}
  constexpr span(Element* first, Element* last) noexcept
      : data_(first), size_(static_cast<std::size_t>(last - first)) {}
  template <std::size_t n, typename E = Element,
            typename = typename std::enable_if<!std::is_same<E, const char>::value>::type>  // those are texts
  constexpr span(E (&elements)[n]) noexcept : data_(elements), size_(n) {}
  template <typename Container, typename = detail::if_container<Container, Element>>
  constexpr span(Container& elements) noexcept : data_(elements.data()), size_(elements.size()) {}
  template <typename Container, typename = detail::if_container<const Container, Element>>
  constexpr span(const Container& elements) noexcept : data_(elements.data()), size_(elements.size()) {}
  template <typename Other, std::size_t n,
            typename = typename std::enable_if<detail::may_view<Other, Element>::value>::type>
  constexpr span(const span<Other, n>& other) noexcept : data_(other.data()), size_(other.size()) {}
  /// The characters of a text that ends with a zero, without that zero.
  template <typename Text, typename = typename std::enable_if<
                               (std::is_same<Text, const char*>::value || std::is_same<Text, char*>::value) &&
                               std::is_convertible<Text, Element*>::value>::type>
  span(Text text) noexcept : data_(text), size_(std::strlen(text)) {}

  constexpr Element* data() const noexcept { return data_; }
  constexpr std::size_t size() const noexcept { return size_; }
  constexpr bool empty() const noexcept { return size_ == 0; }
  constexpr Element& operator[](std::size_t index) const { return data_[index]; }
  constexpr Element* begin() const noexcept { return data_; }
  constexpr Element* end() const noexcept { return data_ + size_; }

 private:
  Element* data_;
  std::size_t size_;
};

}  // namespace precice
