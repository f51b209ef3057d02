#include "adaptiso/Extraction/detail/SimplifyKeeping.h"

#include <algorithm>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "adaptiso/Core/Errors.h"
#include "adaptive/AdaptiveMethod.h"
#include "adaptive/full/MeshSurface.h"
#include "repair/HashOfPoint.h"
#include "repair/MeshParts.h"

namespace adaptiso::detail {
namespace {

/// From its lowest corner on, so that one triangle has one name.
Triangle rotated(const Triangle& t) {
    const auto least = std::min_element(t.begin(), t.end()) - t.begin();
    return {t[least], t[(least + 1) % 3], t[(least + 2) % 3]};
}

/// By their places: the parts' order is not the mesh's.
void keepPoints(const TriangleMesh& mesh, const std::vector<std::uint8_t>& isKept,
                MeshParts& parts) {
    std::unordered_set<Vec3, HashOfPoint> kept;
    for (std::size_t t = 0; t < isKept.size(); ++t) {
        if (isKept[t] == 0) continue;
        for (const VertexId v : mesh.triangles[t]) kept.insert(mesh.points[v] - parts.origin);
    }
    parts.isKept.resize(parts.points.size(), 0);
    for (std::size_t v = 0; v < parts.points.size(); ++v) {
        if (kept.contains(parts.points[v])) parts.isKept[v] = 1;
    }
}

/// Finds which of the result's points and triangles are the input's.
/// \return  whether all are there that were to stay
bool findKept(const TriangleMesh& mesh, const std::vector<std::uint8_t>& isKept,
              KeepingSimplified& made) {
    std::unordered_map<Vec3, std::int64_t, HashOfPoint> at;
    at.reserve(mesh.points.size());
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        at.emplace(mesh.points[v], static_cast<std::int64_t>(v));
    }
    for (const Vec3& p : made.mesh.points) {
        const auto known = at.find(p);
        made.inputPoint.push_back(known == at.end() ? KeepingSimplified::kNew : known->second);
    }
    std::set<Triangle> kept;
    for (std::size_t t = 0; t < isKept.size(); ++t) {
        if (isKept[t] != 0) kept.insert(rotated(mesh.triangles[t]));
    }
    std::size_t found = 0;
    for (const auto& [a, b, c] : made.mesh.triangles) {
        const Triangle old{made.inputPoint[a], made.inputPoint[b], made.inputPoint[c]};
        const bool isOld = std::find(old.begin(), old.end(), KeepingSimplified::kNew) == old.end();
        const bool wasKept = isOld && kept.contains(rotated(old));
        made.isKept.push_back(static_cast<std::uint8_t>(wasKept));
        found += static_cast<std::size_t>(wasKept);
    }
    return found == kept.size();
}

}  // namespace

std::optional<KeepingSimplified> simplifyKeeping(const TriangleMesh& mesh,
                                                 const std::vector<std::uint8_t>& isKept,
                                                 double maxErrorMm, const BoundingBox* within,
                                                 bool mends) {
    try {
        MeshParts parts = takeApart(mesh, true);
        if (parts.degenerate != 0 || parts.duplicate != 0) return std::nullopt;
        keepPoints(mesh, isKept, parts);
        MeshSurface full(mesh, parts, maxErrorMm);
        if (within != nullptr) {
            full.stayIn({within->minimum - parts.origin, within->maximum - parts.origin});
        }
        AdaptiveOptions aims;
        aims.maxErrorMm = maxErrorMm;
        AdaptiveResult result = simplifyWithin(full, aims, {}, mends);
        KeepingSimplified made;
        made.mesh = std::move(result.mesh);
        made.errorBoundMm = result.errorBoundMm;
        if (!mesh.normals.empty()) made.mesh.normals = normalsFrom(mesh, made.mesh);
        if (findKept(mesh, isKept, made)) return made;
    } catch (const InternalError&) {  // nothing could be proved
    }
    return std::nullopt;
}

}  // namespace adaptiso::detail
