#include "MendDistances.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "NearnessProof.h"
#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/Reach.h"
#include "adaptiso/MeshQuality/HausdorffInterval.h"

namespace adaptiso::detail {
namespace {

/// Triangles at one place.
class PlaceParts {
public:
    void add(const Corners& c) {
        for (const Vec3& p : c) reach_.add(p);
        area_ += 0.5 * norm(areaVector2(c[0], c[1], c[2]));
        ++triangles_;
    }
    MendedPlace place() const {
        MendedPlace place;
        place.areaMm2 = area_;
        place.triangles = triangles_;
        place.spanMm = reach_.spanMm();
        place.middleMm = reach_.middleMm();
        return place;
    }

private:
    Reach reach_;
    double area_ = 0;
    std::int64_t triangles_ = 0;
};

/// A part of a triangle of the input that is not in the result.
struct LostPiece {
    Corners corners;
    std::uint32_t triangle;
};

/// The part of a convex polygon on one side of a plane across an axis.
std::vector<Vec3> clipped(const std::vector<Vec3>& polygon, int axis, double plane, double sign) {
    std::vector<Vec3> kept;
    for (std::size_t n = 0; n < polygon.size(); ++n) {
        const Vec3 &a = polygon[n], &b = polygon[(n + 1) % polygon.size()];
        const double heightA = sign * (a[axis] - plane), heightB = sign * (b[axis] - plane);
        if (heightA >= 0) kept.push_back(a);
        if ((heightA < 0) == (heightB < 0)) continue;
        kept.push_back(a + heightA / (heightA - heightB) * (b - a));
    }
    return kept;
}

/// What a cell holds of a triangle.
void addInCell(const MendInput& input, const BoundingBox& cell, std::uint32_t triangle,
               std::vector<LostPiece>& pieces) {
    const Corners corners = cornersOf(input.mesh, triangle);
    std::vector<Vec3> polygon(corners.begin(), corners.end());
    for (int axis = 0; axis < 3; ++axis) {
        polygon = clipped(polygon, axis, cell.minimum[axis], 1);
        polygon = clipped(polygon, axis, cell.maximum[axis], -1);
    }
    for (std::size_t n = 2; n < polygon.size(); ++n) {
        pieces.push_back({{polygon[0], polygon[n - 1], polygon[n]}, triangle});
    }
}

/// What could not be proved to lie near the result: of one piece.
struct FarPiece {
    std::uint32_t triangle;
    bool isInner;  ///< within the solid on both sides
    std::vector<Corners> parts;
};

bool isWider(const MendedPlace& a, const MendedPlace& b) {
    return a.spanMm > b.spanMm;
}

/// Places of what hangs together by points of the input.
std::vector<MendedPlace> placesOf(const MendInput& input, const std::vector<FarPiece>& pieces,
                                  bool areInner) {
    DisjointSets sets(std::ssize(input.mesh.points));
    for (const FarPiece& piece : pieces) {
        const auto& [a, b, c] = input.mesh.triangles[piece.triangle];
        if (piece.isInner != areInner) continue;
        sets.join(a, b);
        sets.join(a, c);
    }
    std::map<std::int64_t, PlaceParts> reaches;
    for (const FarPiece& piece : pieces) {
        if (piece.isInner != areInner) continue;
        PlaceParts& reach = reaches[sets.find(input.mesh.triangles[piece.triangle][0])];
        for (const Corners& c : piece.parts) reach.add(c);
    }
    std::vector<MendedPlace> places;
    for (const auto& [set, reach] : reaches) places.push_back(reach.place());
    std::stable_sort(places.begin(), places.end(), isWider);
    return places;
}

}  // namespace

std::vector<std::pair<MendedPlace, std::vector<std::int64_t>>> connectedPlaces(
    const TriangleMesh& mesh, const std::vector<std::uint8_t>& isMarked) {
    DisjointSets sets(std::ssize(mesh.points));
    for (std::size_t t = 0; t < isMarked.size(); ++t) {
        if (isMarked[t] == 0) continue;
        sets.join(mesh.triangles[t][0], mesh.triangles[t][1]);
        sets.join(mesh.triangles[t][0], mesh.triangles[t][2]);
    }
    std::map<std::int64_t, std::vector<std::int64_t>> bySet;
    for (std::size_t t = 0; t < isMarked.size(); ++t) {
        if (isMarked[t] != 0) bySet[sets.find(mesh.triangles[t][0])].push_back(t);
    }
    std::vector<std::pair<MendedPlace, std::vector<std::int64_t>>> places;
    for (auto& [set, triangles] : bySet) {
        PlaceParts reach;
        for (const std::int64_t t : triangles) reach.add(cornersOf(mesh, t));
        places.emplace_back(reach.place(), std::move(triangles));
    }
    std::stable_sort(places.begin(), places.end(),
                     [](const auto& a, const auto& b) { return isWider(a.first, b.first); });
    return places;
}

void findBridges(const MendInput& input, const MendLattice& lattice, double boundMm,
                 MendAssembly& assembly) {
    std::vector<std::int64_t> inDoubt;
    for (std::int64_t t = 0; t < std::ssize(assembly.source); ++t) {
        const MendSource source = assembly.source[t];
        const bool isInDoubt = source == MendSource::Filled ||
                               assembly.origin[t] >= input.firstCap() ||
                               (!input.capOf.empty() && source == MendSource::Moved);
        if (isInDoubt) inDoubt.push_back(t);
    }
    if (inDoubt.empty()) return;
    const TriangleMesh given = input.given();
    const NearnessProof proof(given, boundMm);
    parallelForPieces(std::ssize(inDoubt), 64, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t n = begin; n < end; ++n) {
            NearnessProof::Result found;
            proof.prove(cornersOf(assembly.mesh, inDoubt[n]), lattice.spacing() / 4, found);
            assembly.source[inDoubt[n]] =
                found.others.empty() ? MendSource::Moved : MendSource::Filled;
        }
    });
}

void proveDistances(const MendInput& input, const AabbTree& tree, const WindingField& field,
                    const MendRegion& region, const MendLattice& lattice,
                    const std::vector<std::uint64_t>& cellsWithSurface,
                    const MendAssembly& assembly, double boundMm, MendStatistics& statistics) {
    statistics.resultToInputMm = statistics.inputToResultMm = statistics.movedMm;
    TriangleMesh moved;  // of the result, what is not the input's
    moved.points = assembly.mesh.points;
    for (std::size_t t = 0; t < assembly.source.size(); ++t) {
        const bool isAsked =
            assembly.source[t] == MendSource::Moved || assembly.source[t] == MendSource::Cut;
        if (isAsked) moved.triangles.push_back(assembly.mesh.triangles[t]);
    }
    if (!moved.triangles.empty()) {
        HausdorffOptions options;
        options.isSymmetric = false;
        options.limitMm = boundMm;
        statistics.resultToInputMm += hausdorffDistance(moved, input.given(), options).aToB.upperMm;
    }
    std::vector<LostPiece> pieces;
    for (std::size_t n = 0; n < assembly.inner.size(); ++n) {
        if (assembly.innerOf[n] >= input.firstCap()) continue;
        pieces.push_back({assembly.inner[n], assembly.innerOf[n]});
    }
    const std::int64_t innerPieces = std::ssize(pieces);
    double upperMm = assembly.thinnedMm;  // of what was kept of cut triangles
    for (const std::uint64_t cell : region.cells()) {
        // what lies in a cell with new surface was within a cell's diagonal of that
        if (std::binary_search(cellsWithSurface.begin(), cellsWithSurface.end(), cell)) {
            upperMm = std::sqrt(3.0) * lattice.spacing() + assembly.thinnedMm;
            continue;
        }
        const LatticePosition at = positionOf(cell);
        const BoundingBox box = lattice.boxOf(at, at);
        tree.forEachOverlap(box, [&](std::int64_t t) {
            if (t >= input.firstCap() || !mayTouch(cornersOf(input.mesh, t), box)) return;
            addInCell(input, box, static_cast<std::uint32_t>(t), pieces);
        });
    }
    const std::int64_t firstPair = std::ssize(pieces);
    for (const LostPair& pair : input.lostPairs) pieces.push_back({pair.corners, pair.triangle});
    const NearnessProof proof(assembly.mesh, boundMm);
    std::vector<NearnessProof::Result> proved(pieces.size());
    std::vector<std::uint8_t> isInner(pieces.size());
    parallelForPieces(std::ssize(pieces), 64, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t n = begin; n < end; ++n) {
            const Corners& c = pieces[n].corners;
            if (n < innerPieces) {
                proved[n].others.push_back(c);  // dropped as a whole, however near
            } else {
                proof.prove(c, lattice.spacing() / 4, proved[n]);
            }
            if (proved[n].others.empty()) continue;
            const Vec3 middle = 1.0 / 3 * (c[0] + c[1] + c[2]);
            // half a turn less in front, half a turn more behind; pairs make no difference
            const bool isWithin = n < firstPair
                                      ? field.at(middle, std::int64_t{pieces[n].triangle}) >= 1
                                      : field.at(middle) >= 0.5;
            isInner[n] = isWithin ? 1 : 0;
        }
    });
    std::vector<FarPiece> far;
    for (std::size_t n = 0; n < proved.size(); ++n) {
        upperMm = std::max(upperMm, proved[n].upperMm);
        if (proved[n].others.empty()) continue;
        far.push_back({pieces[n].triangle, isInner[n] != 0, std::move(proved[n].others)});
    }
    statistics.inputToResultMm += upperMm;
    const auto withCut = [](std::vector<MendedPlace> places, const std::vector<MendedPlace>& cut) {
        places.insert(places.end(), cut.begin(), cut.end());
        std::stable_sort(places.begin(), places.end(), isWider);
        return places;
    };
    statistics.inner = withCut(placesOf(input, far, true), input.inner);
    statistics.thin = withCut(placesOf(input, far, false), input.outer);
}

}  // namespace adaptiso::detail
