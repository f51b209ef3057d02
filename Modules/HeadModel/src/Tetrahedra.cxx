#include "adaptiso/HeadModel/Tetrahedra.h"

#include <array>
#include <numeric>
#include <string>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {

std::int32_t tissueNumber(HeadSurface surface, std::size_t count) {
    constexpr std::int32_t kBrain = 2, kCsf = 3, kSkull = 4, kScalp = 5;
    switch (surface) {
        case HeadSurface::Brain:
            return kBrain;
        case HeadSurface::InnerSkull:
            return count == kHeadSurfaceCount ? kCsf : kBrain;
        case HeadSurface::OuterSkull:
            return kSkull;
        case HeadSurface::OuterSkin:
            return kScalp;
    }
    throw InternalError("tissueNumber: unknown head surface");
}

std::string_view tissueName(std::int32_t number) {
    constexpr std::array<std::string_view, 4> kNames{"brain", "csf", "skull", "scalp"};
    return number >= 2 && number <= 5 ? kNames[static_cast<std::size_t>(number - 2)] : "unknown";
}

MesherInput headMesherInput(std::span<const TriangleMesh> surfaces) {
    MesherInput input;
    TriangleMesh all;
    std::vector<std::vector<std::int64_t>> ofWall;
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
        const VertexId first = std::ssize(all.points);
        ofWall.emplace_back(surfaces[n].triangles.size());
        std::iota(ofWall.back().begin(), ofWall.back().end(), std::ssize(all.triangles));
        all.points.insert(all.points.end(), surfaces[n].points.begin(), surfaces[n].points.end());
        for (const auto& [a, b, c] : surfaces[n].triangles) {
            all.triangles.push_back({first + a, first + b, first + c});
            input.walls.push_back(static_cast<std::int32_t>(n + 1));
        }
    }
    const AabbTree tree(all);
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
        const auto number = static_cast<std::int32_t>(n + 1);
        std::vector<std::int32_t> walls{number};
        if (n > 0) walls.push_back(number - 1);
        input.volumes.push_back({number, walls, pointBeside(all, tree, ofWall[n], false)});
    }
    input.points = std::move(all.points);
    input.triangles = std::move(all.triangles);
    return input;
}

std::vector<TetrahedraRegion> headRegions(std::span<const TriangleMesh> surfaces) {
    std::vector<TetrahedraRegion> regions;
    double within = 0, inner = 0;
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
        const std::int32_t tissue = tissueNumber(headSurface(n, surfaces.size()), surfaces.size());
        const double mm3 = enclosedVolume(surfaces[n]);
        regions.push_back({tissue, std::string(tissueName(tissue)), mm3 - within,
                           inner + surfaceArea(surfaces[n])});
        within = mm3;
        inner = surfaceArea(surfaces[n]);
    }
    return regions;
}

std::vector<TetrahedraRegion> allTissues() {
    std::vector<TetrahedraRegion> regions;
    for (std::size_t n = 0; n < kHeadSurfaceCount; ++n) {
        const std::int32_t tissue =
            tissueNumber(headSurface(n, kHeadSurfaceCount), kHeadSurfaceCount);
        regions.push_back({tissue, std::string(tissueName(tissue)), 0, 0});
    }
    return regions;
}

std::vector<double> tissueConductivities(const ConductivityModel& model) {
    std::vector<double> values;
    for (std::size_t n = 0; n < kHeadSurfaceCount; ++n) {
        values.push_back(model.within(headSurface(n, kHeadSurfaceCount), kHeadSurfaceCount));
    }
    return values;
}

}  // namespace adaptiso
