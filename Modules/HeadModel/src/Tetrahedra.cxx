#include "adaptiso/HeadModel/Tetrahedra.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {

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
        const HeadTissue& tissue = tissueWithin(headSurface(n, surfaces.size()), surfaces.size());
        const double mm3 = enclosedVolume(surfaces[n]);
        regions.push_back({tissue.number, std::string(tissue.name), mm3 - within,
                           inner + surfaceArea(surfaces[n])});
        within = mm3;
        inner = surfaceArea(surfaces[n]);
    }
    return regions;
}

std::vector<TetrahedraRegion> allTissues(std::size_t count) {
    const std::size_t all = std::max<std::size_t>(count, 4);
    std::vector<TetrahedraRegion> regions;
    for (std::size_t n = 0; n < all; ++n) {
        const HeadTissue& tissue = tissueWithin(headSurface(n, all), all);
        regions.push_back({tissue.number, std::string(tissue.name), 0, 0});
    }
    return regions;
}

std::vector<double> tissueConductivities(const ConductivityModel& model, std::size_t count) {
    const std::size_t all = std::max<std::size_t>(count, 4);
    std::vector<double> values;
    for (std::size_t n = 0; n < all; ++n) values.push_back(model.within(headSurface(n, all), all));
    return values;
}

}  // namespace adaptiso
