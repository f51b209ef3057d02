#include "FinishBoundaries.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "BallTopology.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {

std::string_view toString(HeadSurface surface) {
    switch (surface) {
        case HeadSurface::InnerSkull:
            return "inner_skull";
        case HeadSurface::OuterSkull:
            return "outer_skull";
        case HeadSurface::OuterSkin:
            return "outer_skin";
    }
    throw InternalError("toString: unknown head surface");
}

}  // namespace adaptiso

namespace adaptiso::headmodel {
namespace {

/// Rounds of smoothing and mending topology: what was mended gets smooth before it is final.
constexpr int kMostRounds = 3;

std::string nameOf(std::size_t surface) {
    std::string name(toString(static_cast<HeadSurface>(surface)));
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

}  // namespace

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
    requireUpTo("cutNecksMm", options.cutNecksMm, 20);
    require(options.maxSkullMm > options.minSkullMm && options.maxSkullMm <= 200, "maxSkullMm",
            options.maxSkullMm, "more than minSkullMm and at most 200");
}

HeadBoundaries finished(RawBoundaries raw, const BoundaryOptions& options) {
    const double step = stepMm(raw.grid);
    const std::array<double, 2> gaps{options.minSkullMm, options.minScalpMm};
    HeadBoundaries result;
    result.notes = std::move(raw.notes);
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
        part = settled(std::move(part), raw.grid, options.smoothingMm, nameOf(n), result.notes);
        result.solids.push_back({raw.grid, std::move(part)});
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
