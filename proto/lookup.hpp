#pragma once

namespace strake {

/// The value that a map has for a key, else `otherwise`.
template <class Map>
typename Map::mapped_type at_or(const Map& map, const typename Map::key_type& key,
                                typename Map::mapped_type otherwise = {}) {
  const auto found = map.find(key);
  return found == map.end() ? otherwise : found->second;
}

}  // namespace strake
