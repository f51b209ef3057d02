#include "SkullBand.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/HeadModel/Plausibility.h"

namespace adaptiso::headmodel {
namespace {

constexpr double kRayStepMm = 0.5;
constexpr double kMostScalpMm = 15;
constexpr double kSpreadMm = 6;
constexpr double kOutlierMm = 3;
constexpr double kLostBrainMm = 4;
/// Weight of "as thick as usual" beside a surface that is seen everywhere, which has about 0.07:
/// a layer of one voxel (h = 1 mm) under a Gaussian of kSpreadMm.
constexpr float kPriorWeight = 0.001f;

struct Ray {
    std::int64_t voxel;     ///< where it starts: a voxel inside with a neighbour outside
    Vec3 start, direction;  ///< in voxels; unit length
};

struct Grid {
    const Index3& size;
    std::int64_t offset(int axis) const {
        return axis == 0 ? 1 : axis == 1 ? size[0] : size[0] * size[1];
    }
};

double sampleAt(const std::vector<float>& values, const Index3& size, const Vec3& at) {
    std::int64_t base = 0, stride = 1;
    std::array<double, 3> weight;
    for (int a = 0; a < 3; ++a) {
        const double p = std::clamp(at[a], 0.0, static_cast<double>(size[a]) - 1.001);
        const auto low = static_cast<std::int64_t>(p);
        weight[a] = p - static_cast<double>(low);
        base += low * stride;
        stride *= size[a];
    }
    double sum = 0;
    for (int n = 0; n < 8; ++n) {
        double w = 1;
        std::int64_t voxel = base;
        for (int a = 0; a < 3; ++a) {
            const bool isHigh = (n >> a & 1) != 0;
            w *= isHigh ? weight[a] : 1 - weight[a];
            if (isHigh) voxel += Grid{size}.offset(a);
        }
        sum += w * values[voxel];
    }
    return sum;
}

/// A ray for every voxel that the surface of `part` passes, from the surface along its normal.
std::vector<Ray> raysFrom(const std::vector<float>& part, const Index3& size) {
    constexpr auto kHalf = static_cast<float>(kFractionIsovalue);
    const Grid grid{size};
    std::vector<Ray> rays;
    for (std::int64_t k = 1; k + 1 < size[2]; ++k) {
        for (std::int64_t j = 1; j + 1 < size[1]; ++j) {
            for (std::int64_t i = 1; i + 1 < size[0]; ++i) {
                const std::int64_t n = i + size[0] * (j + size[1] * k);
                if (part[n] < kHalf) continue;
                Vec3 slope;
                bool isLast = false;
                for (int a = 0; a < 3; ++a) {
                    const float low = part[n - grid.offset(a)], high = part[n + grid.offset(a)];
                    slope[a] = (high - low) / 2.0;
                    isLast = isLast || low < kHalf || high < kHalf;
                }
                const double steepness = norm(slope);
                if (!isLast || steepness < 1e-3) continue;
                const Vec3 outward = (-1 / steepness) * slope;
                const double depth = std::min((part[n] - kHalf) / steepness, 1.0);
                rays.push_back(
                    {n,
                     Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)} +
                         depth * outward,
                     outward});
            }
        }
    }
    return rays;
}

struct Search {
    const std::vector<float>& t1;
    const std::vector<float>& skinDepth;
    const std::vector<std::uint8_t>& faces;
    const Index3& size;
    double step;
    const HeadLevels& levels;
    const BoundaryOptions& options;
    double leastMm;
    double startMm;  ///< of rays, from the inner skull

    struct Answer {
        bool reachesSkin = false;
        std::optional<double> thicknessMm;
        bool startsInTissue = false;  ///< as bright as brain, beyond the inner skull
        bool endsAtImage = false;     ///< the image ends there, not the head
    };

    /// An inner skull that is a millimetre too wide leaves little of a thin bone outside: what is
    /// dark begins inside of it, and shows.
    bool isThinSkull() const { return startMm < 0; }

    Answer along(const Ray& ray) const {
        std::vector<double> profile;
        Answer answer;
        const double farMm = options.maxSkullMm + kMostScalpMm;
        for (double mm = startMm; mm <= farMm && !answer.reachesSkin; mm += kRayStepMm) {
            const Vec3 at = ray.start + (mm / step) * ray.direction;
            answer.reachesSkin = sampleAt(skinDepth, size, at) <= 0;
            profile.push_back(sampleAt(t1, size, at));
        }
        if (!answer.reachesSkin) return answer;
        answer.endsAtImage = isBeyondImage(
            ray, startMm + kRayStepMm * static_cast<double>(profile.size() - 1) + 2 * step);
        answer.thicknessMm = thickness(profile);
        answer.startsInTissue = startsInTissue(profile);
        return answer;
    }

    bool isBeyondImage(const Ray& ray, double mm) const {
        const Vec3 at = ray.start + (mm / step) * ray.direction;
        std::int64_t voxel = 0, stride = 1;
        for (int a = 0; a < 3; ++a) {
            voxel += stride * std::clamp<std::int64_t>(std::llround(at[a]), 0, size[a] - 1);
            stride *= size[a];
        }
        return faces[voxel] == 0;
    }

    /// CSF and bone are dark: as much brain as this beyond the inner skull was lost.
    bool startsInTissue(const std::vector<double>& profile) const {
        constexpr int kLost = static_cast<int>(kLostBrainMm / kRayStepMm);
        if (std::ssize(profile) < 2 * kLost) return false;  // a thin scalp on a thin skull
        const double bright = levels.air + 0.5 * (levels.tissue - levels.air);
        return std::all_of(profile.begin(), profile.begin() + kLost,
                           [&](double value) { return value > bright; });
    }

    std::optional<double> thickness(const std::vector<double>& profile) const {
        const auto count = static_cast<int>(profile.size());
        // the scalp: brighter than half of the brain, somewhere in front of the skin
        const double bright = levels.air + 0.5 * (levels.tissue - levels.air);
        const auto most = static_cast<int>((options.maxSkullMm + kMostScalpMm) / kRayStepMm);
        const auto least = std::max(0, count - static_cast<int>(kMostScalpMm / kRayStepMm));
        int scalp = -1;
        double peak = bright;
        for (int n = std::min(count, most) - 1; n >= least; --n) {
            if (profile[n] > peak) {
                peak = profile[n];
                scalp = n;
            } else if (scalp >= 0 &&
                       profile[n] < levels.air + 0.35 * (levels.tissue - levels.air)) {
                break;  // in the bone: what is bright beyond is not scalp
            }
        }
        if (scalp < 0) return std::nullopt;
        // the bone: the darkest within the outer table's reach, before the image is bright again
        const double scalpLevel = std::min(peak, levels.tissue);
        int dark = scalp;
        for (int n = scalp; n >= 0; --n) {
            if (profile[n] < profile[dark]) dark = n;
            const bool isBone = profile[dark] < levels.air + 0.4 * (levels.tissue - levels.air);
            if (isBone && profile[n] > profile[dark] + 0.3 * (scalpLevel - profile[dark])) break;
        }
        const double contrast = scalpLevel - profile[dark];
        if (contrast < 0.5 * (levels.tissue - levels.air)) return std::nullopt;
        const double level = profile[dark] + contrast / 2;
        int edge = dark;
        while (edge < scalp && profile[edge] < level) ++edge;
        const double before = profile[edge - 1], after = profile[edge];
        const double mm = startMm + kRayStepMm * (edge - 1 + (level - before) / (after - before));
        const double shownMm = isThinSkull() ? 0 : leastMm;
        if (mm < shownMm || mm > options.maxSkullMm) return std::nullopt;
        return std::max(mm, leastMm);
    }
};

std::vector<Search::Answer> search(const std::vector<Ray>& rays, const std::vector<float>& t1,
                                   const ImageGeometry& grid, const Mask& skin,
                                   const std::vector<std::uint8_t>& faces, const HeadLevels& levels,
                                   const BoundaryOptions& options) {
    const double step = stepMm(grid);
    // a ray asks for the side alone; between corners of both sides no depth is above two voxels
    const std::vector<float> skinDepth = depthMm(skin, grid, DepthBand::within(3 * step));
    // a child's skull may be thinner than the least that is asked for: it is seen all the same
    const UsualHead usual(options.ageYears);
    const double leastMm =
        usual.isAdult() ? options.minSkullMm : std::min(options.minSkullMm, usual.leastSkullMm);
    const double startMm = usual.isSkullThin() ? -1 : 0;
    const Search search{t1, skinDepth, faces, grid.size, step, levels, options, leastMm, startMm};
    std::vector<Search::Answer> answers(rays.size());
    parallelForPieces(std::ssize(rays), 1024, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t n = begin; n < end; ++n) answers[n] = search.along(rays[n]);
    });
    return answers;
}

/// Thickness everywhere near the surface, from what the rays say: a mean that is smooth over 6 mm
/// needs no lattice as fine as the head's.
class Thickness {
public:
    Thickness(const std::vector<Ray>& rays, const std::vector<Search::Answer>& answers,
              const ImageGeometry& grid, double usualMm)
        : perNode_(std::max(1, static_cast<int>(kSpreadMm / (2.5 * stepMm(grid))))) {
        const double step = stepMm(grid) * perNode_;
        for (int a = 0; a < 3; ++a) {
            lattice_.size[a] = std::max<std::int64_t>((grid.size[a] - 1) / perNode_ + 2, 4);
            lattice_.indexToPhysical.column[a][a] = step;
        }
        mm_.resize(static_cast<std::size_t>(lattice_.voxelCount()), 0);
        std::vector<float> weight = mm_;
        for (std::size_t n = 0; n < rays.size(); ++n) {
            if (!answers[n].thicknessMm) continue;
            const auto mm = static_cast<float>(*answers[n].thicknessMm);
            const Corners at = cornersOf(indexOf(rays[n].voxel, grid.size));
            for (int c = 0; c < 8; ++c) {
                weight[at.node[c]] += at.weight[c];
                mm_[at.node[c]] += at.weight[c] * mm;
            }
        }
        // giving to the nodes around and asking them spread by a sixth of a step squared each
        const double sigmaMm = std::sqrt(kSpreadMm * kSpreadMm - step * step / 3);
        weight = smoothed(std::move(weight), lattice_, sigmaMm);
        mm_ = smoothed(std::move(mm_), lattice_, sigmaMm);
        const auto usual = static_cast<float>(usualMm);
        const float prior = kPriorWeight * static_cast<float>(perNode_ * perNode_ * perNode_);
        for (std::size_t n = 0; n < mm_.size(); ++n) {
            // a recursive filter's tails swing by a little around zero
            const float w = std::max(weight[n], 0.0f);
            mm_[n] = (std::max(mm_[n], 0.0f) + prior * usual) / (w + prior);
        }
    }

    float at(const Index3& voxel) const {
        const Corners corners = cornersOf(voxel);
        float mm = 0;
        for (int c = 0; c < 8; ++c) mm += corners.weight[c] * mm_[corners.node[c]];
        return mm;
    }

    double mostMm() const { return *std::max_element(mm_.begin(), mm_.end()); }

    static Index3 indexOf(std::int64_t voxel, const Index3& size) {
        return {voxel % size[0], voxel / size[0] % size[1], voxel / (size[0] * size[1])};
    }

private:
    struct Corners {
        std::array<std::int64_t, 8> node;
        std::array<float, 8> weight;
    };

    /// The nodes around a voxel, and the parts that each has of it.
    Corners cornersOf(const Index3& voxel) const {
        const Grid grid{lattice_.size};
        std::int64_t base = 0;
        std::array<float, 3> high;
        for (int a = 0; a < 3; ++a) {
            base += voxel[a] / perNode_ * grid.offset(a);
            high[a] = static_cast<float>(voxel[a] % perNode_) / static_cast<float>(perNode_);
        }
        Corners corners;
        for (int c = 0; c < 8; ++c) {
            corners.node[c] = base;
            corners.weight[c] = 1;
            for (int a = 0; a < 3; ++a) {
                const bool isHigh = (c >> a & 1) != 0;
                if (isHigh) corners.node[c] += grid.offset(a);
                corners.weight[c] *= isHigh ? high[a] : 1 - high[a];
            }
        }
        return corners;
    }

    int perNode_;  ///< voxels of the head, along each axis
    ImageGeometry lattice_;
    std::vector<float> mm_;
};

/// Takes away what is off by more than kOutlierMm.
void dropOutliers(const std::vector<Ray>& rays, const Thickness& thickness, const Index3& size,
                  std::vector<Search::Answer>& answers) {
    for (std::size_t n = 0; n < rays.size(); ++n) {
        std::optional<double>& mm = answers[n].thicknessMm;
        if (!mm) continue;
        const float usual = thickness.at(Thickness::indexOf(rays[n].voxel, size));
        if (std::abs(usual - static_cast<float>(*mm)) > kOutlierMm) mm.reset();
    }
}

/// The inner skull grown by the thickness there, as parts of voxels.
std::vector<float> grownBy(const Thickness& thickness, const Mask& innerSkull,
                           const ImageGeometry& grid) {
    const double step = stepMm(grid), most = thickness.mostMm();
    std::vector<float> part = depthMm(innerSkull, grid, {step, most + step});
    const std::int64_t width = grid.size[0];
    parallelForPieces(grid.size[1] * grid.size[2], 64, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t row = begin; row < end; ++row) {
            Index3 at{0, row % grid.size[1], row / grid.size[1]};
            for (at[0] = 0; at[0] < width; ++at[0]) {
                float& voxel = part[row * width + at[0]];
                // far from the shell there is no need to ask
                const bool isFar = voxel < -most - step / 2 || voxel > step / 2;
                voxel = partAtDepth(isFar ? voxel : voxel + thickness.at(at), step);
            }
        }
    });
    return part;
}

/// Rays that start in one cube of 8 mm.
struct Cell {
    std::int64_t rays = 0, seen = 0;
    double voxelFaces = 0;  ///< area
    Vec3 sumMm;
    bool isUnseen() const { return 3 * seen < rays; }
};

/// Fills band.unseenMm2, unseenMm and upperTissueFraction. Unseen are cubes in which less than a
/// third of the rays show a band, joined by faces, edges and corners.
void findUnseen(const std::vector<Ray>& rays, const std::vector<Search::Answer>& answers,
                const ImageGeometry& grid, SkullBand& band) {
    constexpr double kCellMm = 8, kFromBelow = 0.4;
    using Place = std::array<std::int64_t, 3>;
    std::vector<Vec3> starts;
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
    for (const Ray& ray : rays) {
        starts.push_back(grid.toPhysical(ray.start));
        lowest = std::min(lowest, starts.back().z);
        highest = std::max(highest, starts.back().z);
    }
    std::map<Place, Cell> cells;
    std::int64_t towardsScalp = 0, inTissue = 0;
    for (std::size_t n = 0; n < rays.size(); ++n) {
        const Vec3& p = starts[n];
        if (!answers[n].reachesSkin || p.z < lowest + kFromBelow * (highest - lowest)) continue;
        ++towardsScalp;
        inTissue += answers[n].startsInTissue ? 1 : 0;
        if (answers[n].endsAtImage) continue;
        Place place;
        for (int a = 0; a < 3; ++a)
            place[a] = static_cast<std::int64_t>(std::floor(p[a] / kCellMm));
        Cell& cell = cells[place];
        ++cell.rays;
        cell.seen += answers[n].thicknessMm ? 1 : 0;
        cell.sumMm += p;
        // the voxels that a plane passes lie one above each face along the axis it faces most
        const Vec3& d = rays[n].direction;
        cell.voxelFaces += 1 / std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    }
    if (towardsScalp > 0) {
        band.upperTissueFraction =
            static_cast<double>(inTissue) / static_cast<double>(towardsScalp);
    }
    std::erase_if(cells, [](const auto& cell) { return !cell.second.isUnseen(); });
    while (!cells.empty()) {
        std::vector<Place> open{cells.begin()->first};
        Cell patch;
        while (!open.empty()) {
            const Place at = open.back();
            open.pop_back();
            const auto found = cells.find(at);
            if (found == cells.end()) continue;
            patch.rays += found->second.rays;
            patch.voxelFaces += found->second.voxelFaces;
            patch.sumMm += found->second.sumMm;
            cells.erase(found);
            for (std::int64_t k = 0; k < 27; ++k) {
                open.push_back({at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1});
            }
        }
        const double mm2 = patch.voxelFaces * std::pow(stepMm(grid), 2);
        if (mm2 <= band.unseenMm2) continue;
        band.unseenMm2 = mm2;
        band.unseenMm = (1 / static_cast<double>(patch.rays)) * patch.sumMm;
    }
}

}  // namespace

SkullBand findSkullBand(const std::vector<float>& t1, const ImageGeometry& grid,
                        std::vector<float> innerSkull, const Mask& skin,
                        const std::vector<std::uint8_t>& faces, const HeadLevels& levels,
                        const BoundaryOptions& options) {
    const double step = stepMm(grid);
    const std::vector<Ray> rays = raysFrom(innerSkull, grid.size);
    const Mask within = above(innerSkull, kFractionIsovalue);
    freeMemory(innerSkull);  // a head's worth of memory
    std::vector<Search::Answer> answers = search(rays, t1, grid, skin, faces, levels, options);

    SkullBand band;
    std::vector<double> seen;
    std::int64_t towardsScalp = 0, inTissue = 0;
    for (const Search::Answer& answer : answers) {
        towardsScalp += answer.reachesSkin ? 1 : 0;
        inTissue += answer.startsInTissue ? 1 : 0;
        if (answer.thicknessMm) seen.push_back(*answer.thicknessMm);
    }
    if (!seen.empty()) {
        std::nth_element(seen.begin(), seen.begin() + std::ssize(seen) / 2, seen.end());
        band.medianThicknessMm = seen[seen.size() / 2];
        band.seenFraction = static_cast<double>(seen.size()) / static_cast<double>(towardsScalp);
    }
    if (towardsScalp > 0) {
        band.tissueFraction = static_cast<double>(inTissue) / static_cast<double>(towardsScalp);
    }
    dropOutliers(rays, Thickness(rays, answers, grid, options.skullMm), grid.size, answers);
    findUnseen(rays, answers, grid, band);
    for (std::size_t n = 0; n < rays.size(); ++n) {
        if (!answers[n].thicknessMm) continue;
        const Vec3 end = rays[n].start + (*answers[n].thicknessMm / step) * rays[n].direction;
        band.seenMm.push_back(grid.toPhysical(end));
    }
    band.outerSkull = grownBy(Thickness(rays, answers, grid, options.skullMm), within, grid);
    return band;
}

}  // namespace adaptiso::headmodel
