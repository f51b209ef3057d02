#include "SpanTree.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <numeric>
#include <tuple>

namespace adaptiso::detail {
namespace {

constexpr std::int64_t kParallelBuild = 1 << 14;  // below, a task costs more than it saves

template <class Low, class High>
void sortLevel(std::uint32_t* begin, std::uint32_t* end, bool onMinimum, const Low& low,
               const High& high) {
    if (end - begin < 2) return;
    std::uint32_t* middle = begin + (end - begin) / 2;
    if (onMinimum) {
        std::nth_element(begin, middle, end, [&](std::uint32_t a, std::uint32_t b) {
            return std::tie(low[a], a) < std::tie(low[b], b);
        });
    } else {
        std::nth_element(begin, middle, end, [&](std::uint32_t a, std::uint32_t b) {
            return std::tie(high[a], a) < std::tie(high[b], b);
        });
    }
    const auto left = [&] { sortLevel(begin, middle, !onMinimum, low, high); };
    const auto right = [&] { sortLevel(middle + 1, end, !onMinimum, low, high); };
    if (end - begin > kParallelBuild) {
        tbb::parallel_invoke(left, right);
    } else {
        left();
        right();
    }
}

}  // namespace

template <class T>
SpanTree<T>::SpanTree(BlockRanges<T> ranges) : block_(ranges.minimum.size()) {
    std::iota(block_.begin(), block_.end(), 0u);
    sortLevel(block_.data(), block_.data() + block_.size(), true, ranges.minimum, ranges.maximum);
    minimum_.reserve(block_.size());
    for (const std::uint32_t b : block_) minimum_.push_back(ranges.minimum[b]);
    ranges.minimum = {};
    maximum_.reserve(block_.size());
    for (const std::uint32_t b : block_) maximum_.push_back(ranges.maximum[b]);
}

/// The three walks of k-d search. `search` knows nothing yet; `searchMaxMin` runs where every
/// minimum is known to lie below the threshold, `searchMinMax` where every maximum is known to
/// reach it: both drop the test already decided [Livnat1996, section 4.1].
template <class T>
struct SpanTree<T>::Walk {
    const SpanTree& tree;
    const T threshold;
    std::vector<std::uint32_t>& found;
    std::int64_t visited = 0;

    bool minimumBelow(std::int64_t node) const { return tree.minimum_[node] < threshold; }
    bool maximumReaches(std::int64_t node) const { return tree.maximum_[node] >= threshold; }
    void take(std::int64_t node) { found.push_back(tree.block_[node]); }

    void takeAll(std::int64_t begin, std::int64_t end) {
        visited += end - begin;
        found.insert(found.end(), tree.block_.begin() + begin, tree.block_.begin() + end);
    }

    void search(std::int64_t begin, std::int64_t end, bool onMinimum) {
        if (begin >= end) return;
        const std::int64_t root = begin + (end - begin) / 2;
        ++visited;
        if (onMinimum) {
            if (!minimumBelow(root)) return search(begin, root, false);
            if (maximumReaches(root)) take(root);
            searchMaxMin(begin, root, false);  // every minimum there is at most the root's
            search(root + 1, end, false);
        } else {
            if (!maximumReaches(root)) return search(root + 1, end, true);
            if (minimumBelow(root)) take(root);
            search(begin, root, true);
            searchMinMax(root + 1, end, true);  // every maximum there is at least the root's
        }
    }

    /// Only the maximum is left to test.
    void searchMaxMin(std::int64_t begin, std::int64_t end, bool onMinimum) {
        if (begin >= end) return;
        const std::int64_t root = begin + (end - begin) / 2;
        ++visited;
        const bool reaches = maximumReaches(root);
        if (reaches) take(root);
        if (!onMinimum) {
            if (!reaches) return searchMaxMin(root + 1, end, true);
            searchMaxMin(begin, root, true);
            takeAll(root + 1, end);
        } else {
            searchMaxMin(begin, root, false);
            searchMaxMin(root + 1, end, false);
        }
    }

    /// Only the minimum is left to test.
    void searchMinMax(std::int64_t begin, std::int64_t end, bool onMinimum) {
        if (begin >= end) return;
        const std::int64_t root = begin + (end - begin) / 2;
        ++visited;
        const bool below = minimumBelow(root);
        if (below) take(root);
        if (onMinimum) {
            if (!below) return searchMinMax(begin, root, false);
            takeAll(begin, root);
            searchMinMax(root + 1, end, false);
        } else {
            searchMinMax(begin, root, true);
            searchMinMax(root + 1, end, true);
        }
    }
};

template <class T>
std::int64_t SpanTree<T>::search(T threshold, std::vector<std::uint32_t>& found) const {
    Walk walk{*this, threshold, found};
    walk.search(0, size(), true);
    return walk.visited;
}

template class SpanTree<std::uint8_t>;
template class SpanTree<std::int8_t>;
template class SpanTree<std::uint16_t>;
template class SpanTree<std::int16_t>;
template class SpanTree<std::uint32_t>;
template class SpanTree<std::int32_t>;
template class SpanTree<std::uint64_t>;
template class SpanTree<std::int64_t>;
template class SpanTree<float>;
template class SpanTree<double>;

}  // namespace adaptiso::detail
