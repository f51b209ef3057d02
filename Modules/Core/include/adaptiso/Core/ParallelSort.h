#pragma once

#include <functional>

#ifdef ADAPTISO_SERIAL
#include <algorithm>
#else
#include <tbb/parallel_sort.h>
#endif

namespace adaptiso {

/// Sorts `values` (random access) in parallel. Equal ones end in any order: `less` must tell all
/// apart that a result depends on.
template <class Values, class Less = std::less<>>
void parallelSort(Values& values, const Less& less = {}) {
#ifdef ADAPTISO_SERIAL
    std::sort(values.begin(), values.end(), less);
#else
    tbb::parallel_sort(values.begin(), values.end(), less);
#endif
}

}  // namespace adaptiso
