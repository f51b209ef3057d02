#include "adaptiso/SpanSpace/SpanSpaceIndex.h"

#include <string>
#include <variant>

#include "BlockSearch.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/SpanSpace/BlockGrid.h"

namespace adaptiso {

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

namespace {

using namespace detail;

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

/// Result of `search` for an isovalue that some values of T reach and others do not.
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

}  // namespace

namespace {
constexpr std::array<std::string_view, 3> kSearches{"kdtree", "octree", "linear"};
constexpr std::array<std::string_view, 2> kBorders{"closed", "open"};
constexpr std::array<std::string_view, 4> kBlockSizes{"2", "4", "8", "16"};
}  // namespace

std::string_view toString(BlockSearchKind kind) {
    return kSearches[static_cast<std::size_t>(kind)];
}

const Options<IndexOptions>& indexOptions() {
    static const Options<IndexOptions> kRows{
        option<&IndexOptions::blockSize>(
            {.name = "block-size",
             .key = "blockSize",
             .help = "Voxels a side of the index's blocks, and of the largest box of the methods "
                     "boxes and asc",
             .standard = "4",
             .words = kBlockSizes}),
        option<&IndexOptions::border>(
            {.name = "border",
             .key = "border",
             .label = "At the image's border",
             .help = "Where a surface meets the border of the image: closed there, or left open",
             .standard = "closed",
             .words = kBorders}),
        option<&IndexOptions::search>(
            {.name = "search",
             .key = "search",
             .help = "How the blocks that a surface touches are found: kd-tree over their minima "
                     "and maxima, octree, or a look at every block. The surface is the same",
             .standard = "kdtree",
             .words = kSearches})};
    return kRows;
}

SpanSpaceIndex::SpanSpaceIndex(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SpanSpaceIndex::SpanSpaceIndex(SpanSpaceIndex&&) noexcept = default;
SpanSpaceIndex& SpanSpaceIndex::operator=(SpanSpaceIndex&&) noexcept = default;
SpanSpaceIndex::~SpanSpaceIndex() = default;

SpanSpaceIndex SpanSpaceIndex::build(const VolumeView& volume, const IndexOptions& options) {
    const BlockGrid grid =
        BlockGrid::make(volume.geometry().size, options.blockSize, options.border);
    return dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
        return SpanSpaceIndex(std::make_unique<Impl>(
            Impl{grid, pixelTypeOf<T>(), options.search,
                 makeSearch<T>(computeBlockRanges(view, grid), grid, options.search)}));
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
        [&]<class T>(const Impl::Search<T>& search) {
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
            found = blocksAround(view, grid, threshold);
            return grid.blockCount();
        });
    });
}

std::size_t SpanSpaceIndex::memoryBytes() const {
    return std::visit([](const auto& search) { return search->memoryBytes(); }, impl_->search);
}

BlockGrid BlockGrid::make(const Index3& volumeSize, int blockSize, Border border) {
    if (blockSize != 2 && blockSize != 4 && blockSize != 8 && blockSize != 16) {
        throw InvalidInput("BlockGrid: block size " + std::to_string(blockSize) +
                           ", must be 2, 4, 8 or 16");
    }
    BlockGrid grid{blockSize, border, volumeSize, {0, 0, 0}, 0};
    double count = 1;
    if (border == Border::Closed) grid.offset = blockSize;
    for (int axis = 0; axis < 3; ++axis) {
        // every lattice position that can hold the lower end of a crossed edge lies in a block:
        // up to the last sample, whose edge to the virtual layer may be crossed
        const std::int64_t last = grid.offset + volumeSize[axis] - 1;
        grid.blocks[axis] = last / blockSize + 1;
        count *= static_cast<double>(grid.blocks[axis]);
    }
    if (count >= 4294967296.0) {
        throw InvalidInput("the image has 2^32 or more blocks of " + std::to_string(blockSize) +
                           " voxels a side; take a larger block size");
    }
    return grid;
}

}  // namespace adaptiso
