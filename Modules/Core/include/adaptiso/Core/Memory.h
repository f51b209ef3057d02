#pragma once

#include <cstddef>
#include <vector>

namespace adaptiso {

/// Empties vectors and gives their memory back; `v = {}` keeps it: that assigns an empty list of
/// values.
template <class... T>
void freeMemory(std::vector<T>&... vectors) {
    ((vectors = std::vector<T>()), ...);
}

/// Gives memory that was freed back to the system, where the C library (glibc) keeps it for later:
/// after large lists of one step it would lie beside those of the next. Takes about a millisecond
/// for 10 MB; so it is for between the steps of long work. Does nothing with other C libraries.
void returnFreedMemory();

/// For the start of a program whose work is lists that come and go: freed memory of lists up to
/// 32 MB, 128 MB in all, stays with the process until returnFreedMemory(), so that the next list
/// need not have it from the system again, page by page (a tenth of the time of simplification
/// where page faults are dear). It is for the whole process, so no library may ask for it. Does
/// nothing with other C libraries.
void keepFreedMemory();

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
