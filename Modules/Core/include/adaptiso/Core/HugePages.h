#pragma once

#include <cstddef>
#include <vector>

namespace adaptiso {

/// Asks the system for pages of 2 MB where memory that was not touched yet has room for them: a
/// large list is then filled with few page faults, which can take a tenth of the time of a step
/// that fills large lists. Does nothing where the system has no such pages (Linux has them, see
/// madvise(2), MADV_HUGEPAGE).
void preferHugePages(void* begin, std::size_t bytes);

/// list.reserve(count), in huge pages where they are worth it.
template <class T>
void reserveInHugePages(std::vector<T>& list, std::size_t count) {
    if (count <= list.capacity()) return;
    std::vector<T> larger;
    larger.reserve(count);
    preferHugePages(larger.data(), count * sizeof(T));
    larger.insert(larger.end(), list.begin(), list.end());
    list.swap(larger);
}

/// list.assign(count, value), in huge pages where they are worth it. Uses the memory that is there.
template <class T>
void assignInHugePages(std::vector<T>& list, std::size_t count, const T& value = {}) {
    list.clear();
    reserveInHugePages(list, count);
    list.assign(count, value);
}

/// list.shrink_to_fit(), in huge pages where they are worth it.
template <class T>
void shrinkInHugePages(std::vector<T>& list) {
    if (list.size() == list.capacity()) return;
    std::vector<T> smaller;
    reserveInHugePages(smaller, list.size());
    smaller.assign(list.begin(), list.end());
    list.swap(smaller);
}

}  // namespace adaptiso
