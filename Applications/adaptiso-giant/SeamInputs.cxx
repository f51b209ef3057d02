#include <algorithm>

#include "Common/Sha256.h"
#include "Steps.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::giant {

std::vector<Index3> tilesAt(const GiantPlan& plan, const Index3& seam) {
    const IndexBox at = plan.cut().tilesOfSeam(seam);
    std::vector<Index3> tiles;
    for (std::int64_t z = at.first[2]; z < at.end[2]; ++z) {
        for (std::int64_t y = at.first[1]; y < at.end[1]; ++y) {
            const Index3 first{at.first[0], y, z}, end{at.end[0], y, z};
            auto tile = std::ranges::lower_bound(plan.tiles, orderOf(first), {}, orderOf);
            for (; tile != plan.tiles.end() && orderOf(*tile) < orderOf(end); ++tile) {
                tiles.push_back(*tile);
            }
        }
    }
    return tiles;
}

SeamInputs::SeamInputs(const std::filesystem::path& work, const GiantPlan& plan)
    : work_(work), plan_(plan), key_(keyOf(plan)) {}

std::optional<std::string> SeamInputs::ofTile(const Index3& tile) {
    const auto known = known_.find(orderOf(tile));
    if (known != known_.end()) return known->second;
    std::optional<PieceSummary> found = findPiece(work_, "tile", tile, key_);
    if (!found) return std::nullopt;
    known_.erase(known_.begin(), known_.lower_bound({tile[2] - 1, 0, 0}));  // layers gone by
    return known_[orderOf(tile)] = std::move(found->inputs);
}

std::string SeamInputs::of(const Index3& seam) {
    std::string text;
    for (const Index3& tile : tilesAt(plan_, seam)) {
        const std::optional<std::string> inputs = ofTile(tile);
        if (!inputs) {
            throw FileError(pieceFile(work_, "tile", tile).string() +
                            ": is not there, or of another plan; run: adaptiso-giant tile " +
                            work_.string() + " " + idOf(tile));
        }
        text += idOf(tile) + " " + *inputs + "\n";
    }
    return sha256Of(text);
}

bool SeamInputs::areChanged(const Index3& seam, const std::string& inputs) {
    const std::vector<Index3> tiles = tilesAt(plan_, seam);
    const bool areThere =
        std::ranges::all_of(tiles, [&](const Index3& tile) { return ofTile(tile).has_value(); });
    return areThere && of(seam) != inputs;
}

}  // namespace adaptiso::giant
