#include "adaptiso/HeadModel/Plausibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <utility>

#include "FinishBoundaries.h"
#include "Necks.h"
#include "Voxelized.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"
#include "adaptiso/MeshQuality/NearestPlaces.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {

using namespace headmodel;

namespace {

constexpr std::size_t kMostPlaces = 5;
constexpr double kClosingMm = 10;  ///< of necks: as BoundaryOptions::closingMm

std::string fixed(double value, int digits) {
    std::array<char, 48> text;
    std::snprintf(text.data(), text.size(), "%.*f", digits, value);
    return text.data();
}

/// Limits of UsualHead at an age, and between ages on straight lines.
struct UsualAge {
    double years;
    std::array<double, 2> innerSkullCm3;  ///< least, most
    std::array<double, 3> skullMm;        ///< least, usual, most
    std::array<double, 2> scalpMm;        ///< least, most
    double brainToSkinMm;
};

constexpr std::array<UsualAge, 5> kUsualAges{{
    {0, {290, 700}, {1, 2, 4}, {1, 8}, 3},
    {0.25, {400, 1100}, {1, 2.2, 4.5}, {1, 9}, 3},
    {1, {740, 1450}, {1.5, 3, 6}, {1.2, 10}, 4},
    {5, {880, 1750}, {2, 4, 8}, {1.5, 12}, 5},
    {UsualHead::kAdultYears, {950, 1900}, {3, 6, 12}, {2, 15}, 8},
}};

std::string percent(double share) {
    return fixed(100 * share, share < 0.1 ? 1 : 0) + " %";
}

/// Without triangles that have no place, and without normals.
TriangleMesh finiteOf(const TriangleMesh& mesh) {
    TriangleMesh result;
    result.points = mesh.points;
    const auto count = std::ssize(mesh.points);
    for (const Triangle& t : mesh.triangles) {
        const bool isGood = std::all_of(t.begin(), t.end(), [&](VertexId v) {
            return v >= 0 && v < count && std::isfinite(squaredNorm(mesh.points[v]));
        });
        if (isGood) result.triangles.push_back(t);
    }
    return result;
}

double areaOf(const TriangleMesh& mesh, const Triangle& t) {
    const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
    return norm(cross(b - a, c - a)) / 2;
}

Vec3 normalOf(const TriangleMesh& mesh, const Triangle& t) {
    const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
    return cross(b - a, c - a);
}

/// The value below which a share of all lies. \pre values are not empty
double percentileOf(std::vector<double> values, double share) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(
                                         share * static_cast<double>(values.size() - 1) + 0.5);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

double medianOf(std::vector<double> values) {
    const auto middle = values.begin() + std::ssize(values) / 2;
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Unit vectors spread evenly over the sphere (a Fibonacci lattice), 4.5 degrees apart.
std::vector<Vec3> allDirections() {
    constexpr int kCount = 2000;
    std::vector<Vec3> directions;
    for (int n = 0; n < kCount; ++n) {
        const double z = 1 - (2 * n + 1.0) / kCount, radius = std::sqrt(1 - z * z);
        const double turn = 2 * std::numbers::pi / std::numbers::phi * n;
        directions.push_back({radius * std::cos(turn), radius * std::sin(turn), z});
    }
    return directions;
}

/// Depth of points below their convex hull, mm, by its support in some directions: too large by
/// less than 0.1 mm for a head. Only points with z >= leastZ; 0 for others.
std::vector<double> depthBelowHullMm(const std::vector<Vec3>& points, double leastZ) {
    const std::vector<Vec3> directions = allDirections();
    std::vector<double> support(directions.size());
    parallelForPieces(std::ssize(support), 64, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t n = begin; n < end; ++n) {
            support[n] = dot(points.front(), directions[n]);
            for (const Vec3& p : points) support[n] = std::max(support[n], dot(p, directions[n]));
        }
    });
    std::vector<double> depth(points.size());
    parallelForPieces(std::ssize(depth), 64, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t k = begin; k < end; ++k) {
            if (points[k].z < leastZ) continue;
            depth[k] = support[0] - dot(points[k], directions[0]);
            for (std::size_t n = 1; n < directions.size(); ++n) {
                depth[k] = std::min(depth[k], support[n] - dot(points[k], directions[n]));
            }
        }
    });
    return depth;
}

/// A surface and what is measured of it once.
struct MeasuredSurface {
    TriangleMesh mesh;
    std::vector<VertexId> used;  ///< vertices that triangles name, ascending
    std::vector<double> edgeMm;  ///< by vertex: mean of its edges; 0 where not used
    double areaMm2 = 0;
    std::optional<double> volumeMm3;  ///< none unless it is closed
    BoundingBox box;                  ///< of the used vertices
    bool isOfHeadSize = false;

    explicit MeasuredSurface(const TriangleMesh& given)
        : mesh(finiteOf(given)), edgeMm(given.points.size()) {
        std::vector<int> count(mesh.points.size());
        for (const Triangle& t : mesh.triangles) {
            areaMm2 += areaOf(mesh, t);
            for (int n = 0; n < 3; ++n) {
                const VertexId a = t[n], b = t[(n + 1) % 3];
                const double mm = norm(mesh.points[a] - mesh.points[b]);
                for (const VertexId v : {a, b}) {
                    edgeMm[v] += mm;
                    ++count[v];
                }
            }
        }
        for (std::size_t v = 0; v < count.size(); ++v) {
            if (count[v] == 0) continue;
            used.push_back(static_cast<VertexId>(v));
            edgeMm[v] /= count[v];
        }
        if (used.empty()) return;
        box = {mesh.points[used.front()], mesh.points[used.front()]};
        for (const VertexId v : used) box.add(mesh.points[v]);
        isOfHeadSize = true;
        for (int a = 0; a < 3; ++a) {
            const double extent = box.maximum[a] - box.minimum[a];
            isOfHeadSize = isOfHeadSize && extent >= 50 && extent <= 500;
        }
        if (checkTopology(mesh, {.maxExamplesPerDefect = 0}).isWatertight()) {
            volumeMm3 = std::abs(enclosedVolume(mesh));
        }
    }
};

/// Judges nested or single surfaces and collects the notes.
class Judge {
public:
    Judge(const std::vector<MeasuredSurface>& surfaces, const PlausibilityOptions& options)
        : surfaces_(surfaces),
          options_(options),
          usual_(options.usual),
          innerSkull_(options.areHeadLayers && surfaces.size() > 3 ? surfaces.size() - 3 : 0) {}

    std::vector<HeadNote> judged() && {
        for (std::size_t n = 0; n < surfaces_.size(); ++n) {
            const MeasuredSurface& surface = surfaces_[n];
            if (surface.used.empty() || !surface.isOfHeadSize) continue;
            if (n == innerSkull_ && options_.areNested) judgeNecks();
            judgeFlat(n);
            judgeProportion(n);
            if (n == innerSkull_ && options_.areHeadLayers && surface.volumeMm3) judgeVolume();
            if (n == innerSkull_ && options_.areHeadLayers) judgeDents();
        }
        for (std::size_t n = 0; options_.areNested && n + 1 < surfaces_.size(); ++n) {
            if (surfaces_[n].used.empty() || surfaces_[n + 1].used.empty()) continue;
            if (!surfaces_[n].isOfHeadSize || !surfaces_[n + 1].isOfHeadSize) continue;
            judgeLayer(n);
            judgeVertexCounts(n);
        }
        return std::move(notes_);
    }

private:
    HeadNote& add(std::string_view key, std::string_view name, std::size_t surface, bool isNoted,
                  std::string finding) {
        notes_.push_back({key, name, surface, {}, isNoted, false, std::move(finding)});
        return notes_.back();
    }

    void judgeNecks() {
        const MeasuredSurface& surface = surfaces_[innerSkull_];
        if (!surface.volumeMm3) return;
        // room for the closing, and no voxel of the solid at the grid's border
        const double room = kClosingMm + 4;
        ImageGeometry grid;
        grid.indexToPhysical = Mat3::diagonal(1, 1, 1);
        for (int a = 0; a < 3; ++a) {
            grid.originMm[a] = surface.box.minimum[a] - room;
            grid.size[a] = static_cast<std::int64_t>(std::ceil(surface.box.maximum[a] -
                                                               surface.box.minimum[a] + 2 * room)) +
                           1;
        }
        const std::vector<Neck> necks =
            findNecks(largestComponent(voxelized(surface.mesh, grid), grid.size), grid,
                      UsualHead::kNeckBallMm, kClosingMm);
        const std::string ball = "narrower than " + fixed(2 * UsualHead::kNeckBallMm, 0) + " mm";
        std::string finding =
            "no part " + ball + " reaches farther than " + fixed(kNeckReachMm, 0) + " mm";
        if (!necks.empty()) {
            finding = (necks.size() == 1 ? "a part " : std::to_string(necks.size()) + " parts ") +
                      ball + (necks.size() == 1 ? " reaches " : " reach up to ") +
                      fixed(necks.front().reachMm, 0) + " mm, " +
                      fixed(necks.front().mm3 / 1000, 1) + " cm3: a leak down a foramen?";
        }
        HeadNote& note = add("necks", "no narrow neck", innerSkull_, !necks.empty(), finding);
        note.figures = {
            {"neckReachMm", necks.empty() ? 0 : necks.front().reachMm, {}, kNeckReachMm}};
        for (std::size_t n = 0; n < std::min(necks.size(), kMostPlaces); ++n) {
            note.pointsMm.push_back(necks[n].tipMm);
        }
    }

    /// Part of a surface that lies on one plane.
    struct Flat {
        double areaMm2 = 0;
        std::vector<VertexId> vertices;
        Vec3 middleMm;
        std::string where;
        bool isLowerFace = false;  ///< of the image: most scans end in the neck
    };

    /// The part of a surface within `reachMm` of a plane, in triangles along it to 10 degrees.
    static Flat onPlane(const MeasuredSurface& surface, const Vec3& normal, double levelMm,
                        double reachMm) {
        Flat flat;
        std::vector<bool> isOn(surface.mesh.points.size());
        for (const Triangle& t : surface.mesh.triangles) {
            const Vec3 direction = normalOf(surface.mesh, t);
            if (std::abs(dot(direction, normal)) < 0.985 * norm(direction)) continue;
            const bool isNear = std::all_of(t.begin(), t.end(), [&](VertexId v) {
                return std::abs(dot(surface.mesh.points[v], normal) - levelMm) <= reachMm;
            });
            if (!isNear) continue;
            const double area = areaOf(surface.mesh, t);
            flat.areaMm2 += area;
            for (const VertexId v : t) {
                isOn[v] = true;
                flat.middleMm += area / 3 * surface.mesh.points[v];
            }
        }
        if (flat.areaMm2 > 0) flat.middleMm = 1 / flat.areaMm2 * flat.middleMm;
        for (const VertexId v : surface.used) {
            if (isOn[v]) flat.vertices.push_back(v);
        }
        return flat;
    }

    /// The image's six faces. Smoothing and fitting leave a cut within about a voxel of them.
    std::vector<Flat> onFaces(const MeasuredSurface& surface) const {
        std::vector<Flat> flats;
        const ImageGeometry& image = *options_.image;
        for (int a = 0; a < 3; ++a) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            const auto& axes = image.indexToPhysical.column;
            const Vec3 across = cross(axes[b], axes[c]);
            const Vec3 normal = 1 / norm(across) * across;
            for (int end = 0; end < 2; ++end) {
                Vec3 index;
                index[a] = end == 0 ? -0.5 : static_cast<double>(image.size[a]) - 0.5;
                const double level = dot(image.toPhysical(index), normal);
                const double voxel = std::abs(dot(axes[a], normal));
                flats.push_back(onPlane(surface, normal, level, std::max(1.0, voxel) + 0.5));
                const std::string face =
                    faceName((end == 0) == (dot(axes[a], normal) > 0) ? -1.0 * normal : normal);
                flats.back().where = "on the image's " + face + " face: the head is cut there";
                flats.back().isLowerFace = face == "lower";
            }
        }
        return flats;
    }

    /// Name of a face by its outward direction (LPS).
    static std::string faceName(const Vec3& outward) {
        constexpr std::array<std::array<const char*, 2>, 3> kNames{
            {{"right", "left"}, {"front", "back"}, {"lower", "upper"}}};
        int axis = 0;
        for (int a = 1; a < 3; ++a) {
            if (std::abs(outward[a]) > std::abs(outward[axis])) axis = a;
        }
        return kNames[axis][outward[axis] > 0 ? 1 : 0];
    }

    /// Planes across the axes: those at the ends of the bounding box, where a cut by an image lies.
    static std::vector<Flat> onEnds(const MeasuredSurface& surface) {
        constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};
        constexpr double kReachMm = 0.5;
        std::vector<Flat> flats;
        for (int a = 0; a < 3; ++a) {
            for (const double end : {surface.box.minimum[a], surface.box.maximum[a]}) {
                Vec3 normal;
                normal[a] = 1;
                // the cap's rim may bulge beyond it: the plane of its vertices, not of the last one
                std::vector<double> near;
                for (const VertexId v : surface.used) {
                    const double mm = surface.mesh.points[v][a];
                    if (std::abs(mm - end) <= 2 * kReachMm) near.push_back(mm);
                }
                const double level = medianOf(near);
                flats.push_back(onPlane(surface, normal, level, kReachMm));
                flats.back().where = std::string("on one plane across ") + kAxes[a] +
                                     ": cut by the edge of an image?";
            }
        }
        return flats;
    }

    /// A cut through the inner skull, or of the skin beside or above it. Cuts of neck and chin are
    /// usual, and far from brain and electrodes.
    bool losesHead(std::size_t n, const std::vector<Flat>& flats) const {
        if (n == innerSkull_) return !flats.empty();
        const double lowest = surfaces_[innerSkull_].box.minimum.z;
        return n + 1 == surfaces_.size() && std::ranges::any_of(flats, [&](const Flat& flat) {
                   return !flat.isLowerFace && flat.middleMm.z > lowest;
               });
    }

    void judgeFlat(std::size_t n) {
        const MeasuredSurface& surface = surfaces_[n];
        std::vector<Flat> flats = options_.image ? onFaces(surface) : onEnds(surface);
        std::erase_if(flats, [&](const Flat& flat) {
            return flat.areaMm2 < UsualHead::kFlatAreaShare * surface.areaMm2;
        });
        std::ranges::stable_sort(flats, {}, &Flat::isLowerFace);
        double flatMm2 = 0;
        for (const Flat& flat : flats) flatMm2 = std::max(flatMm2, flat.areaMm2);
        std::string finding;
        for (const Flat& flat : flats) {
            finding += (finding.empty() ? "" : "; ") + std::to_string(flat.vertices.size()) +
                       " of " + std::to_string(surface.used.size()) + " vertices (" +
                       percent(flat.areaMm2 / surface.areaMm2) + " of the area, " +
                       fixed(flat.areaMm2 / 100, 0) + " cm2) lie " + flat.where;
        }
        HeadNote& note = add("notCutFlat", "not cut flat", n, !flats.empty(), finding);
        note.figures = {{"flatShare", flatMm2 / surface.areaMm2, {}, UsualHead::kFlatAreaShare}};
        if (options_.image && options_.areHeadLayers && losesHead(n, flats)) {
            note.warning = "head-cut";
        }
        for (const Flat& flat : flats) note.pointsMm.push_back(flat.middleMm);
    }

    /// A vertex that was pulled away has long edges, and those across from it are as ever.
    void judgeProportion(std::size_t n) {
        const MeasuredSurface& surface = surfaces_[n];
        const auto& points = surface.mesh.points;
        std::vector<double> across(points.size());
        std::vector<int> count(points.size());
        for (const Triangle& t : surface.mesh.triangles) {
            for (int k = 0; k < 3; ++k) {
                across[t[k]] += norm(points[t[(k + 1) % 3]] - points[t[(k + 2) % 3]]);
                ++count[t[k]];
            }
        }
        std::vector<std::pair<double, VertexId>> bad;
        double largest = 0;
        for (const VertexId v : surface.used) {
            const double ratio = surface.edgeMm[v] * count[v] / across[v];
            largest = std::max(largest, ratio);
            if (ratio > UsualHead::kMostEdgeRatio) bad.emplace_back(-ratio, v);
        }
        std::sort(bad.begin(), bad.end());
        std::string finding;
        if (!bad.empty()) {
            const VertexId worst = bad.front().second;
            finding = (bad.size() == 1 ? "1 vertex stands"
                                       : std::to_string(bad.size()) + " vertices stand") +
                      " out: edges of " + fixed(surface.edgeMm[worst], 1) +
                      " mm where those round it have " + fixed(across[worst] / count[worst], 1) +
                      " mm";
        }
        HeadNote& note = add("edgesInProportion", "edges in proportion", n, !bad.empty(), finding);
        note.figures = {{"edgeRatio", largest, {}, UsualHead::kMostEdgeRatio}};
        for (std::size_t k = 0; k < std::min(bad.size(), kMostPlaces); ++k) {
            note.pointsMm.push_back(points[bad[k].second]);
        }
    }

    std::string adviceForChildren() const {
        return usual_.isAdult() ? "; of a child give adaptiso-bem --age" : "";
    }

    /// Subject of a limit: "adults have " or "of adults' ".
    std::string usually(bool isUnusual) const {
        if (isUnusual) return usual_.whose() + " have ";
        return usual_.isAdult() ? "of adults' " : "usual of " + usual_.whose() + ": ";
    }

    void judgeVolume() {
        const double cm3 = *surfaces_[innerSkull_].volumeMm3 / 1000;
        const bool isNoted = cm3 < usual_.leastInnerSkullCm3 || cm3 > usual_.mostInnerSkullCm3;
        HeadNote& note = add(
            "innerSkullVolume", "volume of the inner skull", innerSkull_, isNoted,
            fixed(cm3, 0) + " cm3" + (isNoted ? "; " : ", ") + usually(isNoted) +
                fixed(usual_.leastInnerSkullCm3, 0) + " to " + fixed(usual_.mostInnerSkullCm3, 0) +
                " cm3" + (isNoted && cm3 < usual_.leastInnerSkullCm3 ? adviceForChildren() : ""));
        note.figures = {
            {"innerSkullCm3", cm3, usual_.leastInnerSkullCm3, usual_.mostInnerSkullCm3}};
        note.isImpossible = cm3 < UsualHead::kLeastVolumeShare * usual_.leastInnerSkullCm3 ||
                            cm3 > UsualHead::kMostVolumeShare * usual_.mostInnerSkullCm3;
        if (note.isImpossible) {
            note.pointsMm.push_back(surfaces_[innerSkull_].box.middle());
        }
    }

    /// The vault is convex. The base is not: its fossae and the foramen magnum are left out.
    void judgeDents() {
        constexpr double kFromBelow = 0.4;
        const MeasuredSurface& surface = surfaces_[innerSkull_];
        std::vector<Vec3> points;
        for (const VertexId v : surface.used) points.push_back(surface.mesh.points[v]);
        const double bottom = surface.box.minimum.z;
        const std::vector<double> depth =
            depthBelowHullMm(points, bottom + kFromBelow * (surface.box.maximum.z - bottom));
        const auto deepest = std::max_element(depth.begin(), depth.end());
        const bool isNoted = *deepest > UsualHead::kMostDentMm;
        HeadNote& note =
            add("dents", "vault without dents", innerSkull_, isNoted,
                "at most " + fixed(*deepest, 1) + " mm below its convex hull" +
                    (isNoted ? "; sound heads stay below " + fixed(UsualHead::kMostDentMm, 0) +
                                   " mm: a lesion at the cortex, or brain that was lost?"
                             : ""));
        note.warning = "inner-skull-dented";
        note.figures = {{"dentMm", *deepest, {}, UsualHead::kMostDentMm}};
        if (isNoted) note.pointsMm.push_back(points[deepest - depth.begin()]);
    }

    /// Thickness of the layer between two neighbours, and edges against it.
    void judgeLayer(std::size_t n) {
        const MeasuredSurface &inner = surfaces_[n], &outer = surfaces_[n + 1];
        const AabbTree tree(outer.mesh);
        std::vector<double> gap(inner.used.size());
        findNearestPlaces(
            outer.mesh, tree, std::ssize(gap),
            [&](std::int64_t k) { return inner.mesh.points[inner.used[k]]; },
            [&](std::int64_t k, const ClosestPoint& nearest) {
                gap[k] = std::sqrt(nearest.squaredDistanceMm2);
            });
        const bool hasAllLayers = surfaces_.size() == innerSkull_ + 3;
        if (options_.areHeadLayers && hasAllLayers && n >= innerSkull_) judgeThickness(n, gap);

        std::vector<std::pair<double, VertexId>> coarse;
        for (std::size_t k = 0; k < gap.size(); ++k) {
            const double ratio = inner.edgeMm[inner.used[k]] / gap[k];
            if (ratio > UsualHead::kMostEdgesPerGap) coarse.emplace_back(-ratio, inner.used[k]);
        }
        std::sort(coarse.begin(), coarse.end());
        const double share = static_cast<double>(coarse.size()) / static_cast<double>(gap.size());
        const bool isNoted = share > UsualHead::kEdgesPerGapShare;
        std::string finding = "edges longer than " + fixed(UsualHead::kMostEdgesPerGap, 0) +
                              " gaps at " + percent(share) + " of the vertices";
        if (!coarse.empty()) finding += ", up to " + fixed(-coarse.front().first, 1);
        if (isNoted) finding += ": the layer is not resolved there; more vertices are";
        HeadNote& note = add("edgesAgainstGap", "edges against the gap", n, isNoted, finding);
        note.figures = {{"coarseShare", share, {}, UsualHead::kEdgesPerGapShare}};
        note.next = n + 1;
        if (isNoted) note.pointsMm.push_back(inner.mesh.points[coarse.front().second]);
    }

    void judgeThickness(std::size_t n, const std::vector<double>& gap) {
        const MeasuredSurface& inner = surfaces_[n];
        const double middle = (inner.box.minimum.z + inner.box.maximum.z) / 2;
        std::vector<double> upper;
        std::size_t thinnest = 0, thickest = 0;
        bool isFirst = true;
        for (std::size_t k = 0; k < gap.size(); ++k) {
            if (inner.mesh.points[inner.used[k]].z < middle) continue;
            upper.push_back(gap[k]);
            if (isFirst || gap[k] < gap[thinnest]) thinnest = k;
            if (isFirst || gap[k] > gap[thickest]) thickest = k;
            isFirst = false;
        }
        if (upper.empty()) return;
        const bool isSkull = n == innerSkull_;
        const double least = isSkull ? usual_.leastSkullMm : usual_.leastScalpMm;
        const double most = isSkull ? usual_.mostSkullMm : usual_.mostScalpMm;
        const double median = medianOf(upper);
        const bool isThin = median<least, isThick = median> most;
        // single vertices may be off where a vein or a suture is
        const double thick = percentileOf(upper, isSkull ? 0.95 : 0.99);
        const double ratio = thick / percentileOf(upper, 0.05);
        const double mostAnywhere =
            isSkull ? usual_.mostSkullAnywhereMm() : usual_.mostScalpAnywhereMm();
        const bool isSomewhereThick = thick > mostAnywhere;
        const bool isUneven = isSkull && ratio > UsualHead::kMostSkullRatio;
        std::string finding = "median " + fixed(median, 1) + " mm over the upper half (" +
                              fixed(gap[thinnest], 1) + " to " + fixed(gap[thickest], 1) + "), ";
        finding +=
            usually(isThin || isThick) + shortNumber(least) + " to " + shortNumber(most) + " mm";
        if (isThin) finding += adviceForChildren();
        if (isSomewhereThick) {
            finding += "; thicker than " + shortNumber(mostAnywhere) + " mm on more than " +
                       (isSkull ? "5" : "1") + " % of it";
        }
        if (isUneven) {
            finding += "; its thick parts are " + fixed(ratio, 1) +
                       " times as thick as its thin ones, 3 times is usual";
        }
        const bool isNoted = isThin || isThick || isSomewhereThick || isUneven;
        HeadNote& note = isSkull
                             ? add("skullThickness", "thickness of the skull", n, isNoted, finding)
                             : add("scalpThickness", "thickness of the scalp", n, isNoted, finding);
        note.next = n + 1;
        note.warning = "thickness-unusual";
        if (isSkull) {
            note.figures = {{"skullMedianMm", median, least, most},
                            {"skullThickMm", thick, {}, mostAnywhere},
                            {"skullThickToThin", ratio, {}, UsualHead::kMostSkullRatio}};
        } else {
            note.figures = {{"scalpMedianMm", median, least, most},
                            {"scalpThickMm", thick, {}, mostAnywhere}};
        }
        note.isImpossible = median > UsualHead::kMostThicknessShare * most;
        if (isNoted) {
            const bool looksAtThin = isThin || (isUneven && !isThick && !isSomewhereThick);
            note.pointsMm.push_back(
                inner.mesh.points[inner.used[looksAtThin ? thinnest : thickest]]);
        }
    }

    void judgeVertexCounts(std::size_t n) {
        const auto a = static_cast<double>(surfaces_[n].used.size());
        const auto b = static_cast<double>(surfaces_[n + 1].used.size());
        const double ratio = std::max(a, b) / std::min(a, b);
        const bool isNoted = ratio > UsualHead::kMostVertexRatio;
        std::string finding = fixed(a, 0) + " and " + fixed(b, 0) + " vertices";
        if (isNoted) {
            finding += ": one has " + fixed(ratio, 1) +
                       " times as many; the coarser one says how good the model is";
        }
        HeadNote& note = add("vertexCounts", "numbers of vertices match", n, isNoted, finding);
        note.figures = {{"vertexRatio", ratio, {}, UsualHead::kMostVertexRatio}};
        note.next = n + 1;
    }

    const std::vector<MeasuredSurface>& surfaces_;
    const PlausibilityOptions& options_;
    const UsualHead& usual_;
    std::size_t innerSkull_;
    std::vector<HeadNote> notes_;
};

}  // namespace

UsualHead::UsualHead(double years) : ageYears(years) {
    std::size_t n = 1;
    while (n + 1 < kUsualAges.size() && years > kUsualAges[n].years) ++n;
    const UsualAge &before = kUsualAges[n - 1], &after = kUsualAges[n];
    const double share =
        std::clamp((years - before.years) / (after.years - before.years), 0.0, 1.0);
    const auto at = [&](double from, double to) { return std::lerp(from, to, share); };
    leastInnerSkullCm3 = at(before.innerSkullCm3[0], after.innerSkullCm3[0]);
    mostInnerSkullCm3 = at(before.innerSkullCm3[1], after.innerSkullCm3[1]);
    leastSkullMm = at(before.skullMm[0], after.skullMm[0]);
    skullMm = at(before.skullMm[1], after.skullMm[1]);
    mostSkullMm = at(before.skullMm[2], after.skullMm[2]);
    leastScalpMm = at(before.scalpMm[0], after.scalpMm[0]);
    mostScalpMm = at(before.scalpMm[1], after.scalpMm[1]);
    leastBrainToSkinMm = at(before.brainToSkinMm, after.brainToSkinMm);
}

std::string UsualHead::whose() const {
    return isAdult() ? "adults" : "heads of " + shortNumber(ageYears) + " years";
}

std::vector<HeadNote> judgePlausibility(std::span<const TriangleMesh> surfaces,
                                        const PlausibilityOptions& options) {
    std::vector<MeasuredSurface> measured(surfaces.begin(), surfaces.end());
    return Judge(measured, options).judged();
}

}  // namespace adaptiso
