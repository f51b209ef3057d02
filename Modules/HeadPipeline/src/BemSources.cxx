#include "adaptiso/HeadPipeline/BemSources.h"

#include <algorithm>
#include <string>
#include <utility>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

double middleX(const SourceSpace& space) {
    double sum = 0;
    for (const Vec3& p : space.surface.points) sum += p.x;
    return sum / static_cast<double>(space.surface.points.size());
}

std::string percentText(std::int64_t part, std::int64_t all) {
    return formatFixed(100 * static_cast<double>(part) / static_cast<double>(all), 1) + " %";
}

void add(SourceMoves& all, const SourceMoves& more) {
    const auto moved = static_cast<double>(all.moved + more.moved);
    if (moved > 0) {
        all.meanMm = (all.meanMm * static_cast<double>(all.moved) +
                      more.meanMm * static_cast<double>(more.moved)) /
                     moved;
    }
    all.farthestMm = std::max(all.farthestMm, more.farthestMm);
    all.moved += more.moved;
    all.dropped += more.dropped;
    all.outside += more.outside;
}

/// Notes and warnings of sources that were nearer to `surface` than one edge.
void reportMoves(const BemSources& sources, const std::string& surface, BemModel& model) {
    const SourceMoves& moves = sources.moves;
    const std::int64_t count = sources.count(), all = count + moves.dropped;
    constexpr double kMostOutside = 0.5, kManyOutside = 0.05, kFarMm = 5;
    const auto outside = static_cast<double>(moves.outside);
    if (outside > kMostOutside * static_cast<double>(all)) {
        throw InvalidInput(percentText(moves.outside, all) + " of the sources lie outside " +
                           surface + "; are the surfaces of this head, in the same space?");
    }
    if (count == 0) {
        throw InvalidInput("no source finds a place within " + surface +
                           ", one edge away from it; give more vertices");
    }
    if (moves.moved + moves.dropped > 0) {
        model.notes.push_back("sources: " + formatCount(moves.moved) + " nearer to " + surface +
                              " than one edge were moved inwards, by " +
                              formatFixed(moves.meanMm, 1) + " mm on average, " +
                              formatFixed(moves.farthestMm, 1) + " mm at most; " +
                              formatCount(moves.dropped) + " dropped");
    }
    if (outside > kManyOutside * static_cast<double>(all)) {
        model.warnings.push_back({"sources-moved", percentText(moves.outside, all) +
                                                       " of the sources lay outside " + surface +
                                                       "; look at it, and at the cortex"});
    } else if (moves.farthestMm > kFarMm) {
        model.warnings.push_back({"sources-moved", "sources nearer to " + surface +
                                                       " than one edge were moved by up to " +
                                                       formatFixed(moves.farthestMm, 1) +
                                                       " mm; more vertices let them stay"});
    }
}

}  // namespace

std::int64_t BemSources::count() const {
    std::int64_t count = 0;
    for (const SourceSpace& space : spaces) count += std::ssize(space.used);
    return count;
}

std::int64_t BemSources::dipoles() const {
    return count() * (spaces.front().grid ? 3 : 1);
}

void placeSources(BemModel& model, const BemHooks& hooks) {
    const SourceOptions& options = model.options.sources;
    if (model.cortex.empty() && !options.gridMm) return;
    hooks.stage("sources", [&] {
        BemSources sources;
        const TriangleMesh& compartment = model.meshes.front();
        const std::string name = bemSurfaceName(0, model.meshes.size());
        if (options.gridMm) {
            sources.spaces.push_back(gridSources(compartment, *options.gridMm));
            if (sources.count() == 0) {
                throw InvalidInput("a grid of " + formatNumber(*options.gridMm) +
                                   " mm has no point within " + name +
                                   ", one edge away; give a finer grid, or more vertices");
            }
        }
        if (model.cortex.size() == 2 && model.cortex[0].points == model.cortex[1].points) {
            throw InvalidInput("both surfaces are the same; give one for each hemisphere");
        }
        for (TriangleMesh& surface : model.cortex) {
            sources.spaces.push_back(surfaceSources(std::move(surface), options.count));
            if (sources.spaces.back().isOpen) {
                model.notes.push_back(
                    "sources: surface " + std::to_string(sources.spaces.size()) +
                    " is open, so its orientation is not checked: dipoles point along its "
                    "triangles' normals");
            }
            add(sources.moves, keepWithin(sources.spaces.back(), compartment));
        }
        model.cortex.clear();
        // LPS: the left one has the larger x
        std::stable_sort(
            sources.spaces.begin(), sources.spaces.end(),
            [](const SourceSpace& a, const SourceSpace& b) { return middleX(a) > middleX(b); });
        reportMoves(sources, name, model);
        model.notes.push_back("sources: " + formatCount(sources.count()) +
                              (options.gridMm ? " on a grid" : " at vertices of the cortex"));
        model.sources = std::move(sources);
    });
}

void checkPial(BemModel& model) {
    const std::size_t innerSkull = model.options.boundaries.innerSurfaces;
    constexpr double kMostOutside = 0.01;
    std::int64_t outside = 0, all = 0;
    for (const TriangleMesh& surface : model.pial) {
        outside += pointsOutside(surface.points, model.meshes[innerSkull]);
        all += std::ssize(surface.points);
    }
    if (all == 0) return;
    model.notes.push_back("pial surfaces: " + percentText(outside, all) +
                          " of the vertices lie outside inner_skull");
    if (static_cast<double>(outside) <= kMostOutside * static_cast<double>(all)) return;
    model.warnings.push_back({"pial-outside", percentText(outside, all) +
                                                  " of the pial surfaces' vertices lie outside "
                                                  "inner_skull; look at the result"});
}

}  // namespace adaptiso
