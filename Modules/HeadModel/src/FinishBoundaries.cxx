#include "FinishBoundaries.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "BallTopology.h"
#include "WorkingGrid.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"

namespace adaptiso {

std::string_view toString(HeadSurface surface) {
    constexpr std::array<std::string_view, kHeadSurfaceCount> kNames{
        "white_matter", "brain", "inner_skull", "outer_skull", "outer_skin"};
    return kNames.at(static_cast<std::size_t>(surface));
}

HeadSurface headSurface(std::size_t n, std::size_t count) {
    const bool isKnown = (count == 1 || (count >= 3 && count <= kHeadSurfaceCount)) && n < count;
    if (!isKnown) {
        throw InvalidInput("a head model has 1, 3, 4 or 5 surfaces, not " + std::to_string(count));
    }
    return count == 1 ? HeadSurface::InnerSkull
                      : static_cast<HeadSurface>(kHeadSurfaceCount - count + n);
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
void keepWithin(std::vector<float>& part, const Mask& solid, const ImageGeometry& grid,
                double gapMm) {
    const double step = stepMm(grid);
    const std::vector<float> depth = depthMm(solid, grid, {gapMm + step, step});
    forVoxels(part, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t n = begin; n < end; ++n) {
            part[n] = std::min(part[n], partAtDepth(depth[n] - gapMm, step));
        }
    });
}

/// A solid in a box of the grid that it was made on: a brain takes a third of a head's.
struct BoxedSolid {
    Index3 first{};
    FractionField field;
};

BoxedSolid boxed(const std::vector<float>& part, const ImageGeometry& grid, double roomMm,
                 const std::string& name) {
    Index3 first, last;
    if (!boundingIndices(part, grid.size, kFractionIsovalue, first, last)) {
        throw InvalidInput("the " + name + " is empty");
    }
    const auto room = static_cast<std::int64_t>(std::ceil(roomMm / stepMm(grid))) + 3;
    BoxedSolid box{{}, {grid, {}}};
    for (int a = 0; a < 3; ++a) {
        box.first[a] = std::max<std::int64_t>(first[a] - room, 0);
        last[a] = std::min(last[a] + room, grid.size[a] - 1);
        box.field.grid.size[a] = last[a] - box.first[a] + 1;
    }
    box.field.grid.originMm =
        grid.toPhysical({static_cast<double>(box.first[0]), static_cast<double>(box.first[1]),
                         static_cast<double>(box.first[2])});
    box.field.part.resize(static_cast<std::size_t>(box.field.grid.voxelCount()));
    forEachRow(
        box.first, box.field.grid.size, grid.size, [&](std::int64_t row, std::int64_t inBox) {
            std::copy_n(part.begin() + row, box.field.grid.size[0], box.field.part.begin() + inBox);
        });
    return box;
}

/// Voxels of the grid inside the solid.
Mask insideOf(const BoxedSolid& solid, const Index3& size) {
    Mask inside(static_cast<std::size_t>(size[0] * size[1] * size[2]), 0);
    const Mask inBox = above(solid.field.part, kFractionIsovalue);
    forEachRow(solid.first, solid.field.grid.size, size, [&](std::int64_t row, std::int64_t n) {
        std::copy_n(inBox.begin() + n, solid.field.grid.size[0], inside.begin() + row);
    });
    return inside;
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
    requireUpTo("minGreyMm", options.minGreyMm, 20);
    requireUpTo("sulciMm", options.sulciMm, 30);
    if (!(options.ageYears >= 0 && options.ageYears <= 120)) {
        throw InvalidInput("ageYears is " + shortNumber(options.ageYears) + ", must be 0 to 120");
    }
    if (options.innerSurfaces > 2) throw InvalidInput("innerSurfaces must be 0, 1 or 2");
    if (options.innerSurfaces > 0 && options.innerSkullOnly) {
        throw InvalidInput("one surface and four were asked for");
    }
    requireUpTo("cutNecksMm", options.cutNecksMm, 20);
    require(options.maxSkullMm > options.minSkullMm && options.maxSkullMm <= 200, "maxSkullMm",
            options.maxSkullMm, "more than minSkullMm and at most 200");
}

HeadBoundaries finished(RawBoundaries raw, const BoundaryOptions& options) {
    const double step = stepMm(raw.grid);
    HeadBoundaries result;
    result.notes = std::move(raw.notes);
    result.seenMm = std::move(raw.seenMm);
    result.warnings = std::move(raw.warnings);
    result.doubts = std::move(raw.doubts);
    result.figures = std::move(raw.figures);
    const auto settle = [&](std::vector<float> part, HeadSurface surface) {
        BoxedSolid solid = boxed(part, raw.grid, 3 * options.smoothingMm, nameOf(surface));
        freeMemory(part);  // a head's worth of memory
        solid.field.part = settled(std::move(solid.field.part), solid.field.grid,
                                   options.smoothingMm, nameOf(surface), result.notes);
        return solid;
    };
    Mask within, around;
    for (std::size_t n = 0; n < raw.parts.size(); ++n) {
        tell(options, "smooth", static_cast<double>(n) / static_cast<double>(raw.parts.size()));
        std::vector<float> part = std::move(raw.parts[n]);
        if (n > 0) {
            // smoothing takes a little off the wall's outside, and distances are of voxels
            const double offset = options.minGapMm(headSurface(n - 1, raw.parts.size())) + step / 2;
            growTo(part, depthMm(within, raw.grid, {step, offset + step}), offset, step);
        }
        BoxedSolid solid = settle(std::move(part), headSurface(n, raw.parts.size()));
        within = insideOf(solid, raw.grid.size);
        if (n == 0 && !raw.inner.empty()) around = within;
        result.solids.push_back(std::move(solid.field));
    }
    for (std::size_t n = 0; n < raw.inner.size(); ++n) {
        const HeadSurface surface = n == 0 ? HeadSurface::Brain : HeadSurface::WhiteMatter;
        // distances are of voxels
        keepWithin(raw.inner[n], around, raw.grid, options.minGapMm(surface) + step / 2);
        BoxedSolid solid = settle(std::move(raw.inner[n]), surface);
        if (n + 1 < raw.inner.size()) around = insideOf(solid, raw.grid.size);
        result.solids.insert(result.solids.begin(), std::move(solid.field));
        if (!result.seenMm.empty()) {
            result.seenMm.insert(result.seenMm.begin(), std::move(raw.innerSeenMm[n]));
        }
    }
    return result;
}

void limitOuterSkull(RawBoundaries& raw, const BoundaryOptions& options) {
    const double step = stepMm(raw.grid);
    std::vector<float>& part = raw.parts[1];
    // one distance after the other: each is a head's worth of memory
    keepWithin(part, above(raw.parts[2], kFractionIsovalue), raw.grid, options.minScalpMm);
    const std::vector<float> inner = depthMm(above(raw.parts[0], kFractionIsovalue), raw.grid,
                                             {step, options.maxSkullMm + step});
    forVoxels(part, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t n = begin; n < end; ++n) {
            part[n] = std::min(part[n], partAtDepth(inner[n] + options.maxSkullMm, step));
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
    // three digits, but no power of ten where a whole number will do: 1770, not 1.77e+03
    const bool isLarge = std::abs(value) >= 1000 && std::abs(value) < 1e7;
    std::snprintf(text.data(), text.size(), isLarge ? "%.0f" : "%.3g", value);
    return text.data();
}

}  // namespace adaptiso::headmodel
