#include "FinishBoundaries.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "BallTopology.h"
#include "WorkingGrid.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {

std::string_view toString(HeadSurface surface) {
    switch (surface) {
        case HeadSurface::Brain:
            return "brain";
        case HeadSurface::InnerSkull:
            return "inner_skull";
        case HeadSurface::OuterSkull:
            return "outer_skull";
        case HeadSurface::OuterSkin:
            return "outer_skin";
    }
    throw InternalError("toString: unknown head surface");
}

HeadSurface headSurface(std::size_t n, std::size_t count) {
    const bool isKnown = (count == 1 || count == 3 || count == kHeadSurfaceCount) && n < count;
    if (!isKnown) {
        throw InvalidInput("a head model has 1, 3 or 4 surfaces, not " + std::to_string(count));
    }
    return static_cast<HeadSurface>(count == kHeadSurfaceCount ? n : n + 1);
}

}  // namespace adaptiso

namespace adaptiso::headmodel {
namespace {

/// Rounds of smoothing and mending topology: what was mended gets smooth before it is final.
constexpr int kMostRounds = 3;

std::string nameOf(HeadSurface surface) {
    std::string name(toString(surface));
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
}

void requireClearOfBorder(const std::vector<float>& part, const ImageGeometry& grid,
                          const std::string& name) {
    forEachBorderVoxel(grid.size, [&](std::int64_t voxel) {
        if (part[voxel] >= kFractionIsovalue) {
            throw InternalError("finished: the " + name + " reaches the grid's border");
        }
    });
}

/// Smooth and a ball.
std::vector<float> settled(std::vector<float> part, const ImageGeometry& grid, double sigmaMm,
                           const std::string& name, std::vector<std::string>& notes) {
    std::int64_t changed = 0;
    for (int round = 0; round < kMostRounds; ++round) {
        part = smoothed(std::move(part), grid, sigmaMm);
        requireClearOfBorder(part, grid, name);
        const std::int64_t now = makeBall(part, grid.size);
        changed += now;
        if (now == 0) break;
    }
    if (changed > 0) {
        const double mm3 = static_cast<double>(changed) * std::pow(stepMm(grid), 3);
        notes.push_back(name + ": handles or pinched places mended, " + shortNumber(mm3) +
                        " mm3 changed");
    }
    return part;
}

/// Takes away what lies nearer than `gapMm` to the surface of `solid`, or outside of it.
void keepWithin(std::vector<float>& part, const FractionField& solid, double gapMm) {
    const double step = stepMm(solid.grid);
    const double offset = gapMm + step / 2;  // distances are of voxels
    const std::vector<float> depth =
        depthMm(above(solid.part, kFractionIsovalue), solid.grid, {offset + step, step});
    forVoxels(part, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t n = begin; n < end; ++n) {
            part[n] = std::min(part[n], partAtDepth(depth[n] - offset, step));
        }
    });
}

/// The part of a solid's grid that holds it, with room: a brain takes a third of a head's.
FractionField cropped(const FractionField& solid, double roomMm) {
    Index3 first, last;
    if (!boundingIndices(solid.part, solid.grid.size, kFractionIsovalue, first, last)) {
        throw InvalidInput("the brain is empty");
    }
    const auto room = static_cast<std::int64_t>(std::ceil(roomMm / stepMm(solid.grid))) + 3;
    FractionField part{solid.grid, {}};
    for (int a = 0; a < 3; ++a) {
        first[a] = std::max<std::int64_t>(first[a] - room, 0);
        last[a] = std::min(last[a] + room, solid.grid.size[a] - 1);
        part.grid.size[a] = last[a] - first[a] + 1;
    }
    part.grid.originMm =
        solid.grid.toPhysical({static_cast<double>(first[0]), static_cast<double>(first[1]),
                               static_cast<double>(first[2])});
    part.part.reserve(static_cast<std::size_t>(part.grid.voxelCount()));
    for (std::int64_t k = first[2]; k <= last[2]; ++k) {
        for (std::int64_t j = first[1]; j <= last[1]; ++j) {
            const auto row =
                solid.part.begin() + first[0] + solid.grid.size[0] * (j + solid.grid.size[1] * k);
            part.part.insert(part.part.end(), row, row + part.grid.size[0]);
        }
    }
    return part;
}

}  // namespace

std::vector<float> solidOf(std::vector<float> part, const ImageGeometry& grid,
                           const std::vector<std::uint8_t>& faces, double closingMm) {
    const Mask raw = largestComponent(above(part, kFractionIsovalue), grid.size);
    const Mask solid = filledAtBorder(closed(raw, grid, closingMm), faces, grid.size);
    const std::vector<float> reach = depthMm(raw, grid, DepthBand::within(2 * stepMm(grid)));
    for (std::size_t n = 0; n < part.size(); ++n) {
        if (solid[n] != 0 && raw[n] == 0) part[n] = 1;
        // what was not taken: other pieces, and parts of voxels beside them
        if (solid[n] == 0 && reach[n] < -1.5 * stepMm(grid)) part[n] = 0;
        if (raw[n] != 0 && reach[n] > 1.5 * stepMm(grid)) part[n] = 1;
    }
    return part;
}

std::vector<Vec3> sidesOf(const Mask& mask, const ImageGeometry& grid,
                          const std::vector<std::uint8_t>& faces) {
    const std::array<std::int64_t, 3> stride{1, grid.size[0], grid.size[0] * grid.size[1]};
    std::vector<Vec3> places;
    for (std::int64_t k = 1; k + 1 < grid.size[2]; ++k) {
        for (std::int64_t j = 1; j + 1 < grid.size[1]; ++j) {
            for (std::int64_t i = 1; i + 1 < grid.size[0]; ++i) {
                const std::int64_t n = i + grid.size[0] * (j + grid.size[1] * k);
                if (mask[n] == 0) continue;
                const bool isSide = std::any_of(stride.begin(), stride.end(), [&](std::int64_t s) {
                    return (mask[n - s] == 0 && faces[n - s] != 0) ||
                           (mask[n + s] == 0 && faces[n + s] != 0);
                });
                if (!isSide) continue;
                places.push_back(grid.toPhysical(
                    {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
            }
        }
    }
    return places;
}

double marginMm(const BoundaryOptions& options) {
    // a dilation by the closing radius, or the layers outside a brain at the image's border
    const double layers = options.csfMm + options.minSkullMm + options.minScalpMm;
    return std::max(options.closingMm, layers) + 3 * options.smoothingMm + 4;
}

void checkOptions(const BoundaryOptions& options) {
    const auto require = [](bool isGood, const char* name, double value, const char* rule) {
        if (isGood) return;
        throw InvalidInput(std::string("") + name + " is " + shortNumber(value) + " mm, must be " +
                           rule);
    };
    const auto requireUpTo = [&](const char* name, double value, double most) {
        require(value >= 0 && value <= most, name, value, ("0 to " + shortNumber(most)).c_str());
    };
    requireUpTo("stepMm", options.stepMm, 5);
    requireUpTo("smoothingMm", options.smoothingMm, 10);
    requireUpTo("closingMm", options.closingMm, 30);
    requireUpTo("minSkullMm", options.minSkullMm, 20);
    requireUpTo("minScalpMm", options.minScalpMm, 20);
    requireUpTo("csfMm", options.csfMm, 20);
    requireUpTo("minCsfMm", options.minCsfMm, 20);
    requireUpTo("sulciMm", options.sulciMm, 30);
    if (options.withBrain && options.innerSkullOnly) {
        throw InvalidInput("one surface and four were asked for");
    }
    requireUpTo("cutNecksMm", options.cutNecksMm, 20);
    require(options.maxSkullMm > options.minSkullMm && options.maxSkullMm <= 200, "maxSkullMm",
            options.maxSkullMm, "more than minSkullMm and at most 200");
}

HeadBoundaries finished(RawBoundaries raw, const BoundaryOptions& options) {
    const double step = stepMm(raw.grid);
    const std::array<double, 2> gaps{options.minSkullMm, options.minScalpMm};
    HeadBoundaries result;
    result.notes = std::move(raw.notes);
    result.seenMm = std::move(raw.seenMm);
    result.warnings = std::move(raw.warnings);
    for (std::size_t n = 0; n < raw.parts.size(); ++n) {
        tell(options, "smooth", static_cast<double>(n) / static_cast<double>(raw.parts.size()));
        std::vector<float>& part = raw.parts[n];
        if (n > 0) {
            // smoothing takes a little off the wall's outside, and distances are of voxels
            const double offset = gaps[n - 1] + step / 2;
            growTo(part,
                   depthMm(above(result.solids[n - 1].part, kFractionIsovalue), raw.grid,
                           {step, offset + step}),
                   offset, step);
        }
        part = settled(std::move(part), raw.grid, options.smoothingMm,
                       nameOf(headSurface(n, raw.parts.size())), result.notes);
        result.solids.push_back({raw.grid, std::move(part)});
    }
    if (!raw.brain.empty()) {
        keepWithin(raw.brain, result.solids.front(), options.minCsfMm);
        FractionField brain = cropped({raw.grid, std::move(raw.brain)}, 3 * options.smoothingMm);
        brain.part = settled(std::move(brain.part), brain.grid, options.smoothingMm,
                             nameOf(HeadSurface::Brain), result.notes);
        result.solids.insert(result.solids.begin(), std::move(brain));
        if (!result.seenMm.empty()) {
            result.seenMm.insert(result.seenMm.begin(), std::move(raw.brainSeenMm));
        }
    }
    return result;
}

void limitOuterSkull(RawBoundaries& raw, const BoundaryOptions& options) {
    const double step = stepMm(raw.grid);
    const std::vector<float> inner = depthMm(above(raw.parts[0], kFractionIsovalue), raw.grid,
                                             {step, options.maxSkullMm + step});
    const std::vector<float> skin = depthMm(above(raw.parts[2], kFractionIsovalue), raw.grid,
                                            {options.minScalpMm + step, step});
    std::vector<float>& part = raw.parts[1];
    forVoxels(part, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t n = begin; n < end; ++n) {
            part[n] = std::min({part[n], partAtDepth(inner[n] + options.maxSkullMm, step),
                                partAtDepth(skin[n] - options.minScalpMm, step)});
        }
    });
    growTo(part, inner, options.minSkullMm, step);
}

void growTo(std::vector<float>& part, const std::vector<float>& depth, double offsetMm,
            double step) {
    forVoxels(part, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t n = begin; n < end; ++n) {
            part[n] = std::max(part[n], partAtDepth(depth[n] + offsetMm, step));
        }
    });
}

void tell(const BoundaryOptions& options, const char* stage, double fraction) {
    if (options.progress) options.progress(stage, fraction);
}

std::string shortNumber(double value) {
    std::array<char, 32> text;
    std::snprintf(text.data(), text.size(), "%.3g", value);
    return text.data();
}

}  // namespace adaptiso::headmodel
