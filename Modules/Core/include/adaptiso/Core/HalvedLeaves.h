#pragma once

#include <array>
#include <cstdint>

namespace adaptiso {

/// A node of a binary tree over a list of leaves, and the leaves below it. Every node halves its
/// leaves, down to single ones, and the nodes lie in one array in depth-first order: so where
/// children lie follows from counts alone.
struct HalvedLeaves {
    std::int64_t node, firstLeaf, leaves;

    bool isLeaf() const { return leaves == 1; }
    HalvedLeaves left() const { return {node + 1, firstLeaf, leaves / 2}; }
    HalvedLeaves right() const {
        return {node + 2 * (leaves / 2), firstLeaf + leaves / 2, leaves - leaves / 2};
    }

    /// Nodes left to visit: halving leaves no more than 64 levels, with one node a level left to
    /// do.
    using Stack = std::array<HalvedLeaves, 64>;
};

}  // namespace adaptiso
