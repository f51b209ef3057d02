#pragma once

#include <vector>

namespace adaptiso {

/// Gives a vector's memory back. `v = {}` would keep it: that assigns an empty list of elements.
template <class T>
void release(std::vector<T>& v) {
    std::vector<T>().swap(v);
}

}  // namespace adaptiso
