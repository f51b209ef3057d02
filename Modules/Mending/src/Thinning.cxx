#include "Thinning.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Extraction/Tiles.h"
#include "adaptiso/Extraction/detail/SimplifyKeeping.h"
#include "adaptiso/Extraction/detail/UnitScale.h"

namespace adaptiso::detail {
namespace {

bool canBeThinned(MendSource source) {
    return source == MendSource::Moved || source == MendSource::Cut;
}

/// The triangles that may change, and all that they could come near.
struct Part {
    TriangleMesh mesh;                 ///< with all points of the assembly
    std::vector<std::uint8_t> isKept;  ///< of each triangle
};

Part partOf(const AabbTree& tree, double boundMm, const MendAssembly& assembly) {
    const TriangleMesh& mesh = assembly.mesh;
    std::int64_t origins = 0;
    for (const std::int64_t origin : assembly.origin) origins = std::max(origins, origin + 1);
    std::vector<std::uint8_t> isNear(origins);
    parallelForPieces(std::ssize(assembly.source), 256, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t t = begin; t < end; ++t) {
            if (!canBeThinned(assembly.source[t])) continue;
            BoundingBox box = boxOf(cornersOf(mesh, t));
            box.widen(2 * boundMm);
            tree.forEachOverlap(box, [&](std::int64_t origin) {
                if (origin >= origins) return;
                std::atomic_ref(isNear[origin]).store(1, std::memory_order_relaxed);
            });
        }
    });
    Part part;
    part.mesh.points = mesh.points;
    for (std::size_t t = 0; t < assembly.source.size(); ++t) {
        const MendSource source = assembly.source[t];
        if (source == MendSource::Kept && isNear[assembly.origin[t]] == 0) continue;
        part.mesh.triangles.push_back(mesh.triangles[t]);
        part.isKept.push_back(canBeThinned(source) ? 0 : 1);
    }
    return part;
}

}  // namespace

void thin(const AabbTree& tree, double boundMm, MendAssembly& assembly) {
    if (std::none_of(assembly.source.begin(), assembly.source.end(), canBeThinned)) return;
    Part part = partOf(tree, boundMm, assembly);
    const int exponent = exponentTowardsOne(part.mesh);
    scale(part.mesh, exponent);
    std::optional<KeepingSimplified> made =
        simplifyKeeping(part.mesh, part.isKept, std::ldexp(boundMm, exponent), nullptr, false);
    if (!made) return;
    scale(made->mesh, -exponent);
    std::vector<std::uint8_t> isGone(assembly.source.size());
    std::transform(assembly.source.begin(), assembly.source.end(), isGone.begin(),
                   [](MendSource source) { return canBeThinned(source) ? 1 : 0; });
    std::vector<VertexId> number = std::move(made->inputPoint);
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] != KeepingSimplified::kNew) continue;
        number[v] = std::ssize(assembly.mesh.points);
        assembly.mesh.points.push_back(made->mesh.points[v]);
    }
    for (std::size_t t = 0; t < made->isKept.size(); ++t) {
        if (made->isKept[t] != 0) continue;
        const auto& [a, b, c] = made->mesh.triangles[t];
        assembly.mesh.triangles.push_back({number[a], number[b], number[c]});
        assembly.source.push_back(MendSource::Moved);
        assembly.cell.push_back(0);
        assembly.origin.push_back(-1);
        isGone.push_back(0);
    }
    dropTriangles(assembly, isGone);
    assembly.thinnedMm = std::ldexp(made->errorBoundMm, -exponent);
}

}  // namespace adaptiso::detail
