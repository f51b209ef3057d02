#include "adaptiso/SpanSpace/SpanSpaceIndex.h"

#include <variant>

#include "SpanSpaceIndexImpl.h"
#include "adaptiso/Core/Isovalue.h"
#include "adaptiso/SpanSpace/BlocksAt.h"

namespace adaptiso {
namespace {

/// Blocks of a closed grid that hold virtual samples: what an isovalue touches that every sample
/// of the volume reaches whatever its value.
std::vector<std::uint32_t> blocksAtBorder(const BlockGrid& grid) {
    std::vector<std::uint32_t> found;
    if (grid.border == Border::Open) return found;
    for (std::int64_t b = 0; b < grid.blockCount(); ++b) {
        const Index3 first = grid.firstSample(static_cast<std::uint32_t>(b));
        for (int axis = 0; axis < 3; ++axis) {
            if (first[axis] < 0 || first[axis] + grid.blockSize >= grid.volumeSize[axis]) {
                found.push_back(static_cast<std::uint32_t>(b));
                break;
            }
        }
    }
    return found;
}

/// What `search` finds for an isovalue that some values of T reach and others do not.
/// \param search  (threshold, found) -> ranges looked at
template <class T, class Search>
BlockQuery query(const BlockGrid& grid, double isovalue, const Search& search) {
    BlockQuery result;
    const IsovalueTest<T> inside(isovalue);
    if (inside.kind == IsovalueTest<T>::Kind::All) {
        result.blocks = blocksAtBorder(grid);
    } else if (inside.kind == IsovalueTest<T>::Kind::Some) {
        result.nodesVisited = search(inside.threshold, result.blocks);
    }
    return result;
}

}  // namespace

std::string_view toString(BlockSearchKind kind) {
    switch (kind) {
        case BlockSearchKind::KdTree:
            return "kdtree";
        case BlockSearchKind::Octree:
            return "octree";
        case BlockSearchKind::Linear:
            return "linear";
    }
    throw InternalError("toString: unknown kind of search");
}

SpanSpaceIndex::SpanSpaceIndex(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SpanSpaceIndex::SpanSpaceIndex(SpanSpaceIndex&&) noexcept = default;
SpanSpaceIndex& SpanSpaceIndex::operator=(SpanSpaceIndex&&) noexcept = default;
SpanSpaceIndex::~SpanSpaceIndex() = default;

SpanSpaceIndex SpanSpaceIndex::build(const VolumeView& volume, const IndexOptions& options) {
    const BlockGrid grid =
        BlockGrid::make(volume.geometry().size, options.blockSize, options.border);
    return dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
        return SpanSpaceIndex(std::make_unique<Impl>(Impl{
            grid, pixelTypeOf<T>(), options.search,
            detail::makeSearch<T>(detail::computeBlockRanges(view, grid), grid, options.search)}));
    });
}

const BlockGrid& SpanSpaceIndex::grid() const {
    return impl_->grid;
}

BlockSearchKind SpanSpaceIndex::search() const {
    return impl_->kind;
}

IndexOptions SpanSpaceIndex::options() const {
    return {impl_->grid.blockSize, impl_->grid.border, impl_->kind};
}

PixelType SpanSpaceIndex::pixelType() const {
    return impl_->pixelType;
}

BlockQuery SpanSpaceIndex::blocksAt(double isovalue) const {
    return std::visit(
        [&]<class T>(const std::unique_ptr<const detail::BlockSearch<T>>& search) {
            return query<T>(impl_->grid, isovalue,
                            [&](T threshold, std::vector<std::uint32_t>& found) {
                                return search->search(threshold, found);
                            });
        },
        impl_->search);
}

BlockQuery findBlocksAt(const VolumeView& volume, const BlockGrid& grid, double isovalue) {
    return dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
        return query<T>(grid, isovalue, [&](T threshold, std::vector<std::uint32_t>& found) {
            found = detail::blocksAround(view, grid, threshold);
            return grid.blockCount();
        });
    });
}

std::size_t SpanSpaceIndex::memoryBytes() const {
    return std::visit([](const auto& search) { return search->memoryBytes(); }, impl_->search);
}

}  // namespace adaptiso
