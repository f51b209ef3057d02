#pragma once

#include <vector>

namespace adaptiso {

/// Empties vectors and gives their memory back; `v = {}` keeps it: that assigns an empty list of
/// values.
template <class... T>
void freeMemory(std::vector<T>&... vectors) {
    ((vectors = std::vector<T>()), ...);
}

}  // namespace adaptiso
