#include "adaptiso/MeshQuality/LabelCentres.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "Triangles.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso {
namespace {

using std::int32_t;
using std::int64_t;

/// A line of voxels passes from one region into another.
struct Crossing {
    int64_t line;      ///< j + k * size along j
    int32_t first;     ///< the first centre behind it
    int32_t from, to;  ///< regions
};

/// Finds where the lines of voxels cross triangles, whose corners are indices.
class LineCrossings {
public:
    explicit LineCrossings(const ImageGeometry& geometry)
        : size_(geometry.size), isMirrored_(geometry.isMirrored()) {}

    void add(const std::array<Vec3, 3>& corners, const std::array<int32_t, 2>& labels,
             std::vector<Crossing>& found) const {
        const auto range = [&](int axis) {
            const auto [low, high] =
                std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
            const auto last = static_cast<double>(size_[axis] - 1);
            return std::pair(static_cast<int64_t>(std::clamp(std::ceil(low), 0.0, last + 1)),
                             static_cast<int64_t>(std::clamp(std::floor(high), -1.0, last)));
        };
        const auto [firstJ, lastJ] = range(1);
        const auto [firstK, lastK] = range(2);
        for (int64_t k = firstK; k <= lastK; ++k) {
            for (int64_t j = firstJ; j <= lastJ; ++j) cross(corners, labels, j, k, found);
        }
    }

private:
    void cross(const std::array<Vec3, 3>& corners, const std::array<int32_t, 2>& labels, int64_t j,
               int64_t k, std::vector<Crossing>& found) const {
        const Point2 line{static_cast<double>(j), static_cast<double>(k)};
        const auto flat = [&](int n) { return Point2{corners[n].y, corners[n].z}; };
        const int side = perturbedSide(line, flat(0), flat(1));
        if (side == 0 || perturbedSide(line, flat(1), flat(2)) != side ||
            perturbedSide(line, flat(2), flat(0)) != side) {
            return;
        }
        // the normal points to larger i where the corners go round counter-clockwise in (j, k)
        const bool isForward = (side > 0) != isMirrored_;
        const int32_t first = firstBehind(corners, line, side);
        found.push_back(
            {j + k * size_[1], first, labels[isForward ? 0 : 1], labels[isForward ? 1 : 0]});
    }

    /// The first centre of a line that lies behind the triangle that it crosses; one on the
    /// triangle does.
    int32_t firstBehind(const std::array<Vec3, 3>& corners, const Point2& line, int side) const {
        const auto [low, high] = std::minmax({corners[0].x, corners[1].x, corners[2].x});
        const auto last = static_cast<double>(size_[0]);
        auto begin = static_cast<int64_t>(std::clamp(std::ceil(low), 0.0, last)),
             end = static_cast<int64_t>(std::clamp(std::floor(high) + 1, 0.0, last));
        while (begin < end) {  // between: those before the triangle come first
            const int64_t middle = (begin + end) / 2;
            const Vec3 centre{static_cast<double>(middle), line[0], line[1]};
            const bool isBehind = side * orient3d(corners[0], corners[1], corners[2], centre) >= 0;
            isBehind ? end = middle : begin = middle + 1;
        }
        return static_cast<int32_t>(begin);
    }

    Index3 size_;
    bool isMirrored_;
};

std::vector<Crossing> findCrossings(const LabelledWalls& walls, const ImageGeometry& geometry) {
    const LineCrossings lines(geometry);
    const Mat3 toIndex = inverse(geometry.indexToPhysical);
    constexpr int64_t kGrain = 1 << 14;
    const int64_t count = std::ssize(walls.triangles);
    std::vector<std::vector<Crossing>> pieces(
        static_cast<std::size_t>((count + kGrain - 1) / kGrain));
    parallelForPieces(count, kGrain, [&](int64_t begin, int64_t end) {
        std::vector<Crossing>& found = pieces[begin / kGrain];
        for (int64_t t = begin; t < end; ++t) {
            std::array<Vec3, 3> corners;
            for (int n = 0; n < 3; ++n) {
                corners[n] = toIndex * (walls.points[walls.triangles[t][n]] - geometry.originMm);
            }
            lines.add(corners, walls.labels[t], found);
        }
    });
    std::vector<Crossing> all;
    for (std::vector<Crossing>& piece : pieces) {
        all.insert(all.end(), piece.begin(), piece.end());
        freeMemory(piece);
    }
    std::sort(all.begin(), all.end(), [](const Crossing& a, const Crossing& b) {
        return std::tie(a.line, a.first) < std::tie(b.line, b.first);
    });
    return all;
}

/// Passes the crossings of lines in their order.
class Walk {
public:
    Walk(const std::vector<Crossing>& crossings, int64_t firstLine)
        : next_(std::ranges::lower_bound(crossings, firstLine, {}, &Crossing::line)),
          end_(crossings.end()) {}

    /// Calls `pass` for those of `line` up to the centre i that were not passed.
    template <class Pass>
    void to(int64_t line, int64_t i, const Pass& pass) {
        for (; next_ != end_ && next_->line == line && next_->first <= i; ++next_) pass(*next_);
    }

private:
    std::vector<Crossing>::const_iterator next_, end_;
};

/// Entries minus exits of each region, without zeros.
class Depths {
public:
    explicit Depths(const std::vector<int32_t>& regions) : regions_(regions) {}

    void pass(const Crossing& crossing) {
        change(crossing.from, -1);
        change(crossing.to, 1);
    }
    void clear() { depths_.clear(); }
    bool areOf(int32_t label) const {
        if (!std::binary_search(regions_.begin(), regions_.end(), label)) return depths_.empty();
        return depths_.size() == 1 && depths_.front() == std::pair(label, 1);
    }

private:
    void change(int32_t label, int by) {
        if (!std::binary_search(regions_.begin(), regions_.end(), label)) return;
        const auto at = std::find_if(depths_.begin(), depths_.end(),
                                     [label](const auto& each) { return each.first == label; });
        if (at == depths_.end()) {
            depths_.emplace_back(label, by);
        } else if ((at->second += by) == 0) {
            depths_.erase(at);
        }
    }

    const std::vector<int32_t>& regions_;
    std::vector<std::pair<int32_t, int>> depths_;  ///< few: of the regions at one place
};

void requireSound(const LabelledWalls& walls) {
    if (walls.labels.size() != walls.triangles.size()) {
        throw InvalidInput("findMislabelledCentres: labels must be one pair a triangle");
    }
    for (const Triangle& triangle : walls.triangles) {
        for (const VertexId vertex : triangle) {
            if (vertex < 0 || vertex >= std::ssize(walls.points)) {
                throw InvalidInput(
                    "findMislabelledCentres: triangles name points that aren't there");
            }
        }
    }
    for (const Vec3& p : walls.points) {
        if (!std::isfinite(squaredNorm(p))) {
            throw InvalidInput("findMislabelledCentres: points must be finite");
        }
    }
}

}  // namespace

MislabelledCentres findMislabelledCentres(const LabelledWalls& walls, const VolumeView& map,
                                          const std::vector<int32_t>& regions) {
    requireSound(walls);
    const Index3& size = map.geometry().size;
    const std::vector<Crossing> crossings = findCrossings(walls, map.geometry());
    std::vector<MislabelledCentres> layers(static_cast<std::size_t>(size[2]));
    dispatchPixelType(map, [&](const auto& view) {
        parallelForPieces(size[2], 1, [&](int64_t k, int64_t) {
            MislabelledCentres& found = layers[k];
            Walk walk(crossings, k * size[1]);
            Depths depths(regions);
            for (int64_t j = 0; j < size[1]; ++j) {
                depths.clear();
                for (int64_t i = 0; i < size[0]; ++i) {
                    walk.to(j + k * size[1], i, [&](const Crossing& each) { depths.pass(each); });
                    if (depths.areOf(static_cast<int32_t>(view.at(i, j, k)))) continue;
                    if (found.count++ == 0) found.first = Index3{i, j, k};
                }
                walk.to(j + k * size[1], size[0], [](const Crossing&) {});
            }
        });
    });
    MislabelledCentres all;
    for (const MislabelledCentres& layer : layers) {
        if (!all.first) all.first = layer.first;
        all.count += layer.count;
    }
    return all;
}

VoxelOverlap voxelOverlap(const TriangleMesh& a, const TriangleMesh& b,
                          const ImageGeometry& image) {
    const auto crossingsOf = [&](const TriangleMesh& mesh) {
        const std::vector<std::array<int32_t, 2>> labels(mesh.triangles.size());
        return findCrossings({mesh.points, mesh.triangles, labels}, image);
    };
    const std::vector<Crossing> ofA = crossingsOf(a), ofB = crossingsOf(b);
    const Index3& size = image.size;
    std::vector<VoxelOverlap> layers(static_cast<std::size_t>(size[2]));
    parallelForPieces(size[2], 1, [&](int64_t k, int64_t) {
        VoxelOverlap& found = layers[k];
        Walk walkA(ofA, k * size[1]), walkB(ofB, k * size[1]);
        for (int64_t line = k * size[1]; line < (k + 1) * size[1]; ++line) {
            bool isInA = false, isInB = false;
            for (int64_t i = 0; i <= size[0]; ++i) {  // the last: what lies behind all centres
                walkA.to(line, i, [&](const Crossing&) { isInA = !isInA; });
                walkB.to(line, i, [&](const Crossing&) { isInB = !isInB; });
                if (i == size[0]) continue;
                found.voxelsA += isInA;
                found.voxelsB += isInB;
                found.voxelsBoth += isInA && isInB;
            }
        }
    });
    VoxelOverlap all;
    for (const VoxelOverlap& layer : layers) {
        all.voxelsA += layer.voxelsA;
        all.voxelsB += layer.voxelsB;
        all.voxelsBoth += layer.voxelsBoth;
    }
    return all;
}

}  // namespace adaptiso
