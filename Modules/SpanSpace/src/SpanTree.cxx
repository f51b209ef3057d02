#include <algorithm>
#include <cstddef>
#include <tuple>

#include "BlockSearch.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {
namespace {

constexpr std::int64_t kParallelBuild = 1 << 14;  // below, a task costs more than it saves

template <class Left, class Right>
void inParallelIfLarge(std::int64_t size, const Left& left, const Right& right) {
    if (size > kParallelBuild) {
        parallelInvoke(left, right);
    } else {
        left();
        right();
    }
}

template <class T>
struct Node {
    T low, high;
    std::uint32_t block;
};

template <class T>
void sortLevel(Node<T>* begin, Node<T>* end, bool onMinimum) {
    if (end - begin < 2) return;
    Node<T>* middle = begin + (end - begin) / 2;
    if (onMinimum) {
        std::nth_element(begin, middle, end, [](const Node<T>& a, const Node<T>& b) {
            return std::tie(a.low, a.high, a.block) < std::tie(b.low, b.high, b.block);
        });
    } else {
        std::nth_element(begin, middle, end, [](const Node<T>& a, const Node<T>& b) {
            return std::tie(a.high, a.low, a.block) < std::tie(b.high, b.low, b.block);
        });
    }
    const auto left = [&] { sortLevel(begin, middle, !onMinimum); };
    const auto right = [&] { sortLevel(middle + 1, end, !onMinimum); };
    inParallelIfLarge(end - begin, left, right);
}

}  // namespace

template <class T>
SpanTree<T>::SpanTree(BlockRanges<T> ranges) {
    const std::size_t count = ranges.minimum.size();
    std::vector<Node<T>> nodes(count);
    for (std::size_t b = 0; b < count; ++b) {
        nodes[b] = {ranges.minimum[b], ranges.maximum[b], static_cast<std::uint32_t>(b)};
    }
    sortLevel(nodes.data(), nodes.data() + count, true);
    // the arrays of the ranges become those of the tree
    minimum_ = std::move(ranges.minimum);
    maximum_ = std::move(ranges.maximum);
    block_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        minimum_[i] = nodes[i].low;
        maximum_[i] = nodes[i].high;
        block_[i] = nodes[i].block;
    }
    leastMinimum_ = minimum_;
    greatestMaximum_ = maximum_;
    findExtremes(0, size());
}

template <class T>
void SpanTree<T>::findExtremes(std::int64_t begin, std::int64_t end) {
    if (end - begin < 2) return;
    const std::int64_t root = begin + (end - begin) / 2;
    const auto left = [&] { findExtremes(begin, root); };
    const auto right = [&] { findExtremes(root + 1, end); };
    inParallelIfLarge(end - begin, left, right);
    const auto takeIn = [&](std::int64_t first, std::int64_t last) {
        if (first >= last) return;
        const std::int64_t child = first + (last - first) / 2;
        leastMinimum_[root] = std::min(leastMinimum_[root], leastMinimum_[child]);
        greatestMaximum_[root] = std::max(greatestMaximum_[root], greatestMaximum_[child]);
    };
    takeIn(begin, root);
    takeIn(root + 1, end);
}

/// The three walks of k-d search. `search` knows nothing yet; `searchMaxMin` runs where every
/// minimum is known to lie below the threshold, `searchMinMax` where every maximum is known to
/// reach it: both drop the test already decided [Livnat1996, section 4.1]. Each turns back at a
/// node whose subtree holds nothing on the threshold's side of a test still to be made.
template <class T>
struct SpanTree<T>::Walk {
    const SpanTree& tree;
    const T threshold;
    std::vector<std::uint32_t>& found;
    std::int64_t visited = 0;

    bool minimumBelow(std::int64_t node) const { return tree.minimum_[node] < threshold; }
    bool maximumReaches(std::int64_t node) const { return tree.maximum_[node] >= threshold; }
    bool noMinimumBelow(std::int64_t node) const { return tree.leastMinimum_[node] >= threshold; }
    bool noMaximumReaches(std::int64_t node) const {
        return tree.greatestMaximum_[node] < threshold;
    }
    void take(std::int64_t node) { found.push_back(tree.block_[node]); }

    void takeAll(std::int64_t begin, std::int64_t end) {
        visited += end - begin;
        found.insert(found.end(), tree.block_.begin() + begin, tree.block_.begin() + end);
    }

    void search(std::int64_t begin, std::int64_t end, bool onMinimum) {
        if (begin >= end) return;
        const std::int64_t root = begin + (end - begin) / 2;
        ++visited;
        if (noMinimumBelow(root) || noMaximumReaches(root)) return;
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
        if (noMaximumReaches(root)) return;
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
        if (noMinimumBelow(root)) return;
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
    sortBlocks(found, size());
    return walk.visited;
}

#define ADAPTISO_INSTANTIATE(T) template class SpanTree<T>;
ADAPTISO_FOR_EACH_SAMPLE_TYPE(ADAPTISO_INSTANTIATE)
#undef ADAPTISO_INSTANTIATE

}  // namespace adaptiso::detail
