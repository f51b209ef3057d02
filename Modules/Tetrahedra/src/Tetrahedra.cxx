#include "adaptiso/Tetrahedra/Tetrahedra.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

#include "adaptiso/Core/Bytes.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {

namespace {

/// std::ssize() is of a type that ByteSink does not know where addresses have 32 bits.
template <class T>
std::int64_t countOf(const T& items) {
    return std::ssize(items);
}

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

namespace {

/// Names stand in quotes.
std::string quotable(std::string name) {
    for (char& c : name) {
        if (c == '"' || c == '\n' || c == '\r') c = ' ';
    }
    return name;
}

void writeNames(ByteSink& file, std::span<const TetrahedraRegion> regions) {
    file << "$PhysicalNames\n" << countOf(regions) << "\n";
    for (const TetrahedraRegion& region : regions) {
        file << "3 " << std::int64_t{region.label} << " \"" << quotable(region.name) << "\"\n";
    }
    file << "$EndPhysicalNames\n";
}

/// The place of each label in a list.
std::map<std::int32_t, std::int64_t> placesOf(std::span<const TetrahedraRegion> regions) {
    std::map<std::int32_t, std::int64_t> places;
    for (const TetrahedraRegion& region : regions) {
        places.emplace(region.label, std::ssize(places));
    }
    return places;
}

/// A face between two regions, or at the outside, outward of the region with the smaller number.
struct Wall {
    std::array<VertexId, 3> corners;
    std::int32_t label;
};

/// In the order of their sorted corners.
std::vector<Wall> wallsOf(const TetrahedralMesh& mesh) {
    struct Side {
        std::array<VertexId, 3> key;
        std::array<VertexId, 3> outward;
        std::int32_t label;
    };
    std::vector<Side> sides;
    sides.reserve(4 * mesh.tetrahedra.size());
    for (std::size_t n = 0; n < mesh.tetrahedra.size(); ++n) {
        const auto& [a, b, c, d] = mesh.tetrahedra[n];
        for (const std::array<VertexId, 3>& face :
             {std::array{a, c, b}, std::array{a, b, d}, std::array{b, c, d}, std::array{a, d, c}}) {
            Side side{face, face, mesh.labels[n]};
            std::sort(side.key.begin(), side.key.end());
            sides.push_back(side);
        }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) {
        return std::tie(x.key, x.label) < std::tie(y.key, y.label);
    });
    std::vector<Wall> walls;
    for (std::size_t n = 0; n < sides.size(); ++n) {
        const bool isShared = n + 1 < sides.size() && sides[n].key == sides[n + 1].key;
        if (!isShared || sides[n].label != sides[n + 1].label) {
            walls.push_back({sides[n].outward, sides[n].label});
        }
        if (isShared) ++n;
    }
    return walls;
}

}  // namespace

void writeMsh22(const TetrahedralMesh& mesh, std::span<const TetrahedraRegion> regions,
                const std::filesystem::path& path, bool withWalls) {
    const std::vector<Wall> walls = withWalls ? wallsOf(mesh) : std::vector<Wall>{};
    writeBytes(path, [&](ByteSink& file) {
        file << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
        writeNames(file, regions);
        file << "$Nodes\n" << countOf(mesh.points) << "\n";
        std::int64_t number = 0;
        for (const Vec3& p : mesh.points) file << ++number << " " << p << "\n";
        file << "$EndNodes\n$Elements\n" << countOf(walls) + countOf(mesh.tetrahedra) << "\n";
        std::int64_t element = 0;
        for (const Wall& wall : walls) {
            const std::int64_t tag = 1000 + std::int64_t{wall.label};
            file << ++element << " 2 2 " << tag << " " << tag;
            for (const VertexId corner : wall.corners) file << " " << corner + 1;
            file << "\n";
        }
        for (std::size_t n = 0; n < mesh.tetrahedra.size(); ++n) {
            const auto& [a, b, c, d] = mesh.tetrahedra[n];
            const std::int64_t tissue = mesh.labels[n];
            file << ++element << " 4 2 " << tissue << " " << tissue << " " << a + 1 << " " << b + 1
                 << " " << c + 1 << " " << d + 1 << "\n";
        }
        file << "$EndElements\n";
    });
}

void writeMsh41(const TetrahedralMesh& mesh, std::span<const TetrahedraRegion> regions,
                const std::filesystem::path& path) {
    std::map<std::int32_t, std::int64_t> counts;
    for (const std::int32_t label : mesh.labels) ++counts[label];
    const std::int64_t points = std::ssize(mesh.points), elements = std::ssize(mesh.tetrahedra);
    Vec3 low = mesh.points.front(), high = low;
    for (const Vec3& p : mesh.points) {
        for (int a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], p[a]);
            high[a] = std::max(high[a], p[a]);
        }
    }
    writeBytes(path, [&](ByteSink& file) {
        file << "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
        writeNames(file, regions);
        file << "$Entities\n0 0 0 " << countOf(regions) << "\n";
        for (const TetrahedraRegion& region : regions) {
            const std::int64_t tissue = region.label;
            file << tissue << " " << low << " " << high << " 1 " << tissue << " 0\n";
        }
        file << "$EndEntities\n$Nodes\n1 " << points << " 1 " << points << "\n3 "
             << std::int64_t{regions.front().label} << " 0 " << points << "\n";
        for (std::int64_t n = 1; n <= points; ++n) file << n << "\n";
        for (const Vec3& p : mesh.points) file << p << "\n";
        file << "$EndNodes\n$Elements\n"
             << countOf(regions) << " " << elements << " 1 " << elements << "\n";
        std::int64_t number = 0;
        for (const TetrahedraRegion& region : regions) {
            const std::int32_t tissue = region.label;
            file << "3 " << std::int64_t{tissue} << " 4 " << counts[tissue] << "\n";
            for (std::size_t n = 0; n < mesh.tetrahedra.size(); ++n) {
                if (mesh.labels[n] != tissue) continue;
                const auto& [a, b, c, d] = mesh.tetrahedra[n];
                file << ++number << " " << a + 1 << " " << b + 1 << " " << c + 1 << " " << d + 1
                     << "\n";
            }
        }
        file << "$EndElements\n";
    });
}

void writeVtu(const TetrahedralMesh& mesh, const std::filesystem::path& path) {
    const std::int64_t elements = std::ssize(mesh.tetrahedra);
    writeBytes(path, [&](ByteSink& file) {
        file << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" "
                "byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\""
             << countOf(mesh.points) << "\" NumberOfCells=\"" << elements
             << "\">\n<CellData Scalars=\"tissue\">\n<DataArray type=\"Int32\" Name=\"tissue\" "
                "format=\"ascii\">\n";
        for (const std::int64_t tissue : mesh.labels) file << tissue << "\n";
        file << "</DataArray>\n</CellData>\n<Points>\n<DataArray type=\"Float64\" "
                "NumberOfComponents=\"3\" format=\"ascii\">\n";
        for (const Vec3& p : mesh.points) file << p << "\n";
        file << "</DataArray>\n</Points>\n<Cells>\n<DataArray type=\"Int64\" Name=\"connectivity\" "
                "format=\"ascii\">\n";
        for (const auto& [a, b, c, d] : mesh.tetrahedra) {
            file << a << " " << b << " " << c << " " << d << "\n";
        }
        file << "</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n";
        for (std::int64_t n = 1; n <= elements; ++n) file << 4 * n << "\n";
        file << "</DataArray>\n<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">\n";
        for (std::int64_t n = 0; n < elements; ++n) file << "10\n";
        file << "</DataArray>\n</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
    });
}

void writeDgf(const TetrahedralMesh& mesh, std::span<const TetrahedraRegion> regions,
              const std::filesystem::path& path) {
    const std::map<std::int32_t, std::int64_t> places = placesOf(regions);
    writeBytes(path, [&](ByteSink& file) {
        file << "DGF\nVertex\n";
        for (const Vec3& p : mesh.points) file << p << "\n";
        file << "#\nSimplex\nparameters 1\n";
        for (std::size_t n = 0; n < mesh.tetrahedra.size(); ++n) {
            const auto& [a, b, c, d] = mesh.tetrahedra[n];
            file << a << " " << b << " " << c << " " << d << " " << places.at(mesh.labels[n])
                 << "\n";
        }
        file << "#\nBoundaryDomain\ndefault 1\n#\n";
    });
}

}  // namespace adaptiso
