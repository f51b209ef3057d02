#include "adaptiso/SpanSpace/SpanSpaceIndex.h"

#include <algorithm>
#include <variant>

#include "SpanTree.h"
#include "adaptiso/Core/Isovalue.h"

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

}  // namespace

class SpanSpaceIndex::Impl {
public:
    using AnyTree = std::variant<detail::SpanTree<std::uint8_t>, detail::SpanTree<std::int8_t>,
                                 detail::SpanTree<std::uint16_t>, detail::SpanTree<std::int16_t>,
                                 detail::SpanTree<std::uint32_t>, detail::SpanTree<std::int32_t>,
                                 detail::SpanTree<std::uint64_t>, detail::SpanTree<std::int64_t>,
                                 detail::SpanTree<float>, detail::SpanTree<double>>;

    BlockGrid grid;
    PixelType pixelType;
    AnyTree tree;
};

SpanSpaceIndex::SpanSpaceIndex(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SpanSpaceIndex::SpanSpaceIndex(SpanSpaceIndex&&) noexcept = default;
SpanSpaceIndex& SpanSpaceIndex::operator=(SpanSpaceIndex&&) noexcept = default;
SpanSpaceIndex::~SpanSpaceIndex() = default;

SpanSpaceIndex SpanSpaceIndex::build(const VolumeView& volume, const IndexOptions& options) {
    const BlockGrid grid =
        BlockGrid::make(volume.geometry().size, options.blockSize, options.border);
    return dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
        detail::SpanTree<T> tree(detail::computeBlockRanges(view, grid));
        return SpanSpaceIndex(
            std::make_unique<Impl>(Impl{grid, pixelTypeOf<T>(), Impl::AnyTree(std::move(tree))}));
    });
}

const BlockGrid& SpanSpaceIndex::grid() const {
    return impl_->grid;
}

PixelType SpanSpaceIndex::pixelType() const {
    return impl_->pixelType;
}

BlockQuery SpanSpaceIndex::blocksAt(double isovalue) const {
    BlockQuery query;
    std::visit(
        [&]<class T>(const detail::SpanTree<T>& tree) {
            const InsideTest<T> inside(isovalue);
            if (inside.kind == InsideTest<T>::Kind::None) return;
            if (inside.kind == InsideTest<T>::Kind::All) {
                query.blocks = blocksAtBorder(impl_->grid);
                return;
            }
            query.nodesVisited = tree.search(inside.threshold, query.blocks);
        },
        impl_->tree);
    std::sort(query.blocks.begin(), query.blocks.end());
    return query;
}

std::size_t SpanSpaceIndex::memoryBytes() const {
    return std::visit([](const auto& tree) { return tree.memoryBytes(); }, impl_->tree);
}

}  // namespace adaptiso
