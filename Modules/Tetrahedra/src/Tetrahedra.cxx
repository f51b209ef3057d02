#include "adaptiso/Tetrahedra/Tetrahedra.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "Volume.h"
#include "adaptiso/Core/Numbers.h"

namespace adaptiso {
namespace {

/// The least angle between two faces of an element, degrees.
double leastDihedralDeg(const TetrahedralMesh& mesh, const std::array<VertexId, 4>& t) {
    std::array<Vec3, 4> outward;
    for (int n = 0; n < 4; ++n) {
        const Vec3 &a = mesh.points[t[(n + 1) % 4]], &b = mesh.points[t[(n + 2) % 4]],
                   &c = mesh.points[t[(n + 3) % 4]];
        Vec3 normal = cross(b - a, c - a);
        if (dot(normal, mesh.points[t[n]] - a) > 0) normal = -normal;
        outward[n] = normalized(normal);
    }
    double least = 180;
    for (int m = 0; m < 4; ++m) {
        for (int n = m + 1; n < 4; ++n) {
            const double cosine = std::clamp(-dot(outward[m], outward[n]), -1.0, 1.0);
            least = std::min(least, std::acos(cosine) * 180 / std::numbers::pi);
        }
    }
    return least;
}

double radiusEdge(const TetrahedralMesh& mesh, const std::array<VertexId, 4>& t) {
    const Vec3& o = mesh.points[t[0]];
    const Vec3 a = mesh.points[t[1]] - o, b = mesh.points[t[2]] - o, c = mesh.points[t[3]] - o;
    const Vec3 sum =
        squaredNorm(a) * cross(b, c) + squaredNorm(b) * cross(c, a) + squaredNorm(c) * cross(a, b);
    const double radius = norm(sum) / (2 * std::abs(dot(a, cross(b, c))));
    double shortest = std::numeric_limits<double>::infinity();
    for (int m = 0; m < 4; ++m) {
        for (int n = m + 1; n < 4; ++n) {
            shortest = std::min(shortest, norm(mesh.points[t[m]] - mesh.points[t[n]]));
        }
    }
    return radius / shortest;
}

double rankOf(std::vector<double>& values, double share) {
    const auto at = values.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

}  // namespace

TetrahedraReport checkTetrahedra(const TetrahedralMesh& mesh,
                                 std::span<const TetrahedraRegion> regions) {
    TetrahedraReport report;
    report.counts.resize(regions.size());
    report.volumesMm3.resize(regions.size());
    std::map<std::int32_t, std::size_t> regionOf;
    for (const TetrahedraRegion& region : regions) {
        regionOf[region.label] = report.expectedMm3.size();
        report.expectedMm3.push_back(region.mm3);
    }
    std::vector<double> dihedrals, ratios;
    for (std::size_t n = 0; n < mesh.tetrahedra.size(); ++n) {
        const double mm3 = volumeOf(mesh, mesh.tetrahedra[n]);
        const auto region = regionOf.find(mesh.labels[n]);
        if (region == regionOf.end()) {
            ++report.unlabelled;
        } else {
            ++report.counts[region->second];
            report.volumesMm3[region->second] += mm3;
        }
        if (!(mm3 > 0)) {
            ++report.flat;
            continue;
        }
        dihedrals.push_back(leastDihedralDeg(mesh, mesh.tetrahedra[n]));
        ratios.push_back(radiusEdge(mesh, mesh.tetrahedra[n]));
    }
    if (dihedrals.empty()) return report;
    report.leastDihedralDeg = *std::min_element(dihedrals.begin(), dihedrals.end());
    report.p5DihedralDeg = rankOf(dihedrals, 0.05);
    report.mostRadiusEdge = *std::max_element(ratios.begin(), ratios.end());
    report.p95RadiusEdge = rankOf(ratios, 0.95);
    return report;
}

std::vector<TetrahedraCheck> judgeTetrahedra(const TetrahedraReport& report,
                                             std::span<const TetrahedraRegion> regions) {
    constexpr double kShare = 1e-4, kWallMm = 1e-3;
    std::vector<TetrahedraCheck> checks{
        {"each of a region", report.unlabelled == 0, formatCount(report.unlabelled) + " have none"},
        {"none flat or inverted", report.flat == 0, formatCount(report.flat) + " are"}};
    for (std::size_t n = 0; n < regions.size(); ++n) {
        const double found = report.volumesMm3[n], wanted = report.expectedMm3[n];
        const double allowed = kShare * wanted + kWallMm * regions[n].wallsMm2;
        checks.push_back({"volume of " + regions[n].name + " as within its walls",
                          report.counts[n] > 0 && std::abs(found - wanted) <= allowed,
                          formatShort(found) + " mm3, must be " + formatShort(wanted)});
    }
    return checks;
}

std::string describeTetrahedra(const TetrahedralMesh& mesh, const TetrahedraReport& report,
                               const std::string& mesher) {
    return "tetrahedra: " + formatCount(std::ssize(mesh.tetrahedra)) + " of " +
           formatCount(std::ssize(mesh.points)) + " points by " + mesher +
           "; least dihedral angle " + formatFixed(report.leastDihedralDeg, 1) +
           " deg (5 % below " + formatFixed(report.p5DihedralDeg, 1) +
           "), radius by shortest edge up to " + formatFixed(report.mostRadiusEdge, 1) +
           " (95 % below " + formatFixed(report.p95RadiusEdge, 2) + ")";
}

TetrahedralMesh transformed(TetrahedralMesh mesh, const Mat3& linear, const Vec3& translation) {
    for (Vec3& p : mesh.points) p = linear * p + translation;
    if (determinant(linear) < 0) {
        for (auto& t : mesh.tetrahedra) std::swap(t[2], t[3]);
    }
    return mesh;
}

void takeRegions(TetrahedralMesh& mesh, std::span<const TetrahedraRegion> regions) {
    constexpr VertexId kUnused = -1;
    std::vector<VertexId> place(mesh.points.size(), kUnused);
    std::size_t kept = 0;
    for (std::size_t n = 0; n < mesh.tetrahedra.size(); ++n) {
        const std::int32_t number = mesh.labels[n];
        if (number < 1 || number > std::ssize(regions)) continue;
        mesh.tetrahedra[kept] = mesh.tetrahedra[n];
        mesh.labels[kept] = regions[static_cast<std::size_t>(number - 1)].label;
        for (const VertexId v : mesh.tetrahedra[kept]) place[v] = v;
        ++kept;
    }
    mesh.tetrahedra.resize(kept);
    mesh.labels.resize(kept);
    VertexId next = 0;
    for (std::size_t v = 0; v < place.size(); ++v) {
        if (place[v] == kUnused) continue;
        mesh.points[static_cast<std::size_t>(next)] = mesh.points[v];
        place[v] = next++;
    }
    mesh.points.resize(static_cast<std::size_t>(next));
    for (auto& t : mesh.tetrahedra) {
        for (VertexId& v : t) v = place[v];
    }
}

}  // namespace adaptiso
