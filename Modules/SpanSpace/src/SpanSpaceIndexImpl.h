#pragma once

#include <cstdint>
#include <memory>
#include <variant>

#include "BlockSearch.h"
#include "LinearScan.h"
#include "MinMaxOctree.h"
#include "SpanTree.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"

namespace adaptiso {

namespace detail {

template <class T>
std::unique_ptr<const BlockSearch<T>> makeSearch(BlockRanges<T> ranges, const BlockGrid& grid,
                                                 BlockSearchKind kind) {
    switch (kind) {
        case BlockSearchKind::KdTree:
            return std::make_unique<SpanTree<T>>(std::move(ranges));
        case BlockSearchKind::Octree:
            return std::make_unique<MinMaxOctree<T>>(std::move(ranges), grid);
        case BlockSearchKind::Linear:
            return std::make_unique<LinearScan<T>>(std::move(ranges));
    }
    throw InternalError("SpanSpaceIndex: unknown kind of search");
}

}  // namespace detail

class SpanSpaceIndex::Impl {
public:
    template <class T>
    using Search = std::unique_ptr<const detail::BlockSearch<T>>;
    using AnySearch =
        std::variant<Search<std::uint8_t>, Search<std::int8_t>, Search<std::uint16_t>,
                     Search<std::int16_t>, Search<std::uint32_t>, Search<std::int32_t>,
                     Search<std::uint64_t>, Search<std::int64_t>, Search<float>, Search<double>>;

    BlockGrid grid;
    PixelType pixelType;
    BlockSearchKind kind;
    AnySearch search;
};

}  // namespace adaptiso
