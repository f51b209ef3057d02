#include "adaptiso/Mending/Mend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "BorderCaps.h"
#include "CrossingCuts.h"
#include "HandleCuts.h"
#include "MendAssembly.h"
#include "MendDistances.h"
#include "MendInput.h"
#include "MendRegion.h"
#include "NearnessProof.h"
#include "Thinning.h"
#include "WindingField.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Extraction/Components.h"
#include "adaptiso/Extraction/Tiles.h"
#include "adaptiso/MeshQuality/CrossingSearch.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {
namespace {

using detail::MendAssembly;
using detail::MendInput;
using detail::MendLattice;
using detail::MendRegion;
using detail::MendSource;

/// Parts of 128 of the spacing that the lattice is shifted by: planes of the mesh, which often lie
/// at round numbers, are rarely planes of the lattice.
constexpr std::array<std::array<int, 3>, 4> kShifts{
    {{47, 53, 37}, {75, 29, 61}, {19, 83, 101}, {91, 107, 23}}};
constexpr int kMostRounds = 12;  ///< of one lattice

std::string textOf(const Vec3& p) {
    return "(" + formatShort(p.x) + ", " + formatShort(p.y) + ", " + formatShort(p.z) + ")";
}

double checkedBound(const MendOptions& options, double diagonal) {
    const double bound = options.maxErrorMm.value_or(MendOptions::kPartOfDiagonal * diagonal);
    if (diagonal == 0) throw InvalidInput("mend: no triangle has an area");
    if (!(bound > 0) || !std::isfinite(bound)) {
        throw InvalidInput("mend: maxErrorMm must be more than 0");
    }
    if (bound < MendOptions::kLeastOfDiagonal * diagonal) {
        throw InvalidInput("mend: maxErrorMm is " + formatShort(bound) +
                           ", less than a hundred-thousandth of the mesh's diagonal");
    }
    if (options.maxHoleMm && !(*options.maxHoleMm >= 0)) {
        throw InvalidInput("mend: maxHoleMm must not be negative");
    }
    if (options.removesHandles && options.leavesHolesOpen) {
        throw InvalidInput("mend: removesHandles takes a closed surface: not with leavesHolesOpen");
    }
    if (!options.pieces.keepsAll() && options.leavesHolesOpen) {
        throw InvalidInput("mend: pieces are chosen of closed surfaces: not with leavesHolesOpen");
    }
    return bound;
}

/// A cell's diagonal, as a part of the bound: the rest is what new surface may be thinned by.
constexpr double kLatticePart = 0.75;

/// The largest of three binary digits of which a cell's diagonal is within its part of the bound.
double spacingFor(double boundMm) {
    constexpr double kDigits = 8;
    int exponent = 0;
    const double fraction = std::frexp(kLatticePart * boundMm / std::sqrt(3.0), &exponent);
    return std::ldexp(std::floor(fraction * kDigits) / kDigits, exponent);
}

/// Planes of the lattice, a hundredth of a cell apart, must be told apart where the mesh lies.
void requireDigits(const BoundingBox& box, double diagonal, double boundMm) {
    double farthest = 0;
    for (const Vec3& p : {box.minimum, box.maximum}) {
        farthest = std::max({farthest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
    const double spacing = spacingFor(boundMm / 2);  // points may move by some of the bound
    if (!(diagonal > 1e-90 && diagonal < 1e90) || spacing / 128 < farthest * 4.5e-16) {
        throw InvalidInput("mend: coordinates of " + formatShort(farthest) +
                           " have too few digits for a bound of " + formatShort(boundMm) + " mm");
    }
}

/// Cells in and around triangles of the result that cross others or have no area, where these are
/// not all in the region. \param isSound  set to whether there is none such triangle
std::vector<std::uint64_t> cellsOfFaults(const MendAssembly& assembly, const MendRegion& region,
                                         bool& isSound) {
    const auto triangles = detail::inShort(assembly.mesh);
    // the input's own were found apart
    const auto isNew = [&](std::uint32_t t) { return assembly.source[t] != MendSource::Kept; };
    const CrossingPairs crossing =
        findCrossingPairs({assembly.mesh.points, triangles},
                          [&](std::uint32_t a, std::uint32_t b) { return isNew(a) || isNew(b); });
    std::vector<std::uint32_t> faulty = crossing.undecided;
    for (const auto& pair : crossing.pairs) faulty.insert(faulty.end(), pair.begin(), pair.end());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        if (isNew(t) && isDegenerate(assembly.mesh, assembly.mesh.triangles[t])) {
            faulty.push_back(t);
        }
    }
    isSound = faulty.empty();
    std::vector<std::uint64_t> cells;
    const auto addAround = [&](const detail::LatticePosition& cell) {
        for (int n = 0; n < 27; ++n) {
            const detail::LatticePosition near{cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1,
                                               cell[2] + n / 9 - 1};
            if (!region.contains(near)) cells.push_back(detail::keyOf(near));
        }
    };
    for (const std::uint32_t t : faulty) {
        if (assembly.source[t] == MendSource::Moved || assembly.source[t] == MendSource::Filled) {
            addAround(detail::positionOf(assembly.cell[t]));
        } else if (assembly.source[t] == MendSource::Cut) {
            region.forEachCellOf(cornersOf(assembly.mesh, t), addAround);
        }
    }
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    return cells;
}

/// Drops pieces that are new, in part at least, and no thicker than a cell: along sheets that bound
/// no solid the winding number passes a half here and there.
void dropCrumbs(MendAssembly& assembly, double spacingMm) {
    struct Piece {
        double volume = 0, area = 0;
        bool hasNew = false;
    };
    const ComponentLabels labels = labelComponents(assembly.mesh);
    const Vec3 reference = assembly.mesh.points.empty() ? Vec3{} : assembly.mesh.points[0];
    std::vector<Piece> pieces(labels.count);
    const auto pieceOf = [&](std::size_t t) {
        return labels.ofVertex[assembly.mesh.triangles[t][0]];
    };
    for (std::size_t t = 0; t < assembly.source.size(); ++t) {
        Piece& piece = pieces[pieceOf(t)];
        const Corners c = cornersOf(assembly.mesh, static_cast<std::int64_t>(t));
        piece.volume += dot(c[0] - reference, cross(c[1] - reference, c[2] - reference)) / 6;
        piece.area += 0.5 * norm(areaVector2(c[0], c[1], c[2]));
        piece.hasNew = piece.hasNew || assembly.source[t] == MendSource::Moved ||
                       assembly.source[t] == MendSource::Filled;
    }
    std::vector<std::uint8_t> isDropped(assembly.source.size());
    bool hasCrumbs = false;
    for (std::size_t t = 0; t < isDropped.size(); ++t) {
        const Piece& piece = pieces[pieceOf(t)];
        // a plate's thickness; a ball's is three times as much
        if (!piece.hasNew || 2 * std::abs(piece.volume) > spacingMm * piece.area) continue;
        isDropped[t] = 1;
        hasCrumbs = true;
        if (assembly.origin[t] < 0) continue;
        assembly.inner.push_back(cornersOf(assembly.mesh, static_cast<std::int64_t>(t)));
        assembly.innerOf.push_back(static_cast<std::uint32_t>(assembly.origin[t]));
    }
    if (hasCrumbs) dropTriangles(assembly, isDropped);
}

/// Gives each fan of triangles at a point a point of its own: holes left open may meet there.
void splitFans(TriangleMesh& mesh) {
    const auto corners = std::ssize(mesh.triangles) * 3;
    DisjointSets fans(corners);
    std::map<std::pair<VertexId, VertexId>, std::int64_t> at;  // a half-edge's first corner
    for (std::int64_t c = 0; c < corners; ++c) {
        const Triangle& t = mesh.triangles[c / 3];
        const std::int64_t next = c / 3 * 3 + (c + 1) % 3;
        const auto beside = at.find({t[(c + 1) % 3], t[c % 3]});
        if (beside != at.end()) {
            const std::int64_t other = beside->second;
            fans.join(c, other / 3 * 3 + (other + 1) % 3);
            fans.join(next, other);
        }
        at.emplace(std::pair(t[c % 3], t[(c + 1) % 3]), c);
    }
    std::map<std::int64_t, VertexId> pointOf;
    std::vector<std::uint8_t> isTaken(mesh.points.size());
    for (std::int64_t c = 0; c < corners; ++c) {
        VertexId& v = mesh.triangles[c / 3][c % 3];
        const auto [found, isNew] = pointOf.try_emplace(fans.find(c), v);
        if (isNew && std::exchange(isTaken[v], std::uint8_t{1}) != 0) {
            found->second = std::ssize(mesh.points);
            mesh.points.push_back(Vec3(mesh.points[v]));
        }
        v = found->second;
    }
}

/// The parts of borders that hang together, the widest first.
/// \param give  calls its argument with the two points of each border edge
template <class Give>
std::vector<MendedPlace> borderPlaces(const std::vector<Vec3>& points, const Give& give) {
    TriangleMesh borders{points, {}, {}};  // an edge as a triangle without area
    give([&](VertexId a, VertexId b) { borders.triangles.push_back({a, b, b}); });
    const std::vector<std::uint8_t> all(borders.triangles.size(), 1);
    std::vector<MendedPlace> places;
    for (const auto& border : detail::connectedPlaces(borders, all)) places.push_back(border.first);
    return places;
}

[[noreturn]] void refuseHole(const MendedPlace& place, double maxHoleMm, const MendInput& input) {
    std::string text = "mend: a hole near " + textOf(place.middleMm) + " is " +
                       formatBound(place.spanMm, 2) + " mm wide, more than maxHoleMm, " +
                       formatMeasure(maxHoleMm) + " mm";
    const auto borders = borderPlaces(input.mesh.points, [&](const auto& add) {
        for (const auto& [a, b] : input.borders) add(a, b);
    });
    if (!borders.empty() && borders[0].spanMm > place.spanMm) {
        text += "; the widest border spans " + formatBound(borders[0].spanMm, 2) + " mm";
    }
    throw InvalidInput(text);
}

[[noreturn]] void refuseNothing(double maxErrorMm) {
    throw InvalidInput("mend: the triangles enclose no volume that the bound, " +
                       formatShort(maxErrorMm) + " mm, leaves");
}

/// Refuses triangles that enclose nothing. The winding number is harmonic off the triangles: if it
/// is at least a half anywhere, it is so just behind a triangle, which is tried at four places.
void requireVolume(const MendInput& input, const detail::WindingField& field, double boundMm,
                   double maxErrorMm) {
    const double depthMm =  // what is thinner is dropped
        std::min(spacingFor(boundMm) / 4, 0.01 * norm(boundingBox(input.mesh).size()));
    for (std::int64_t t = 0; t < std::ssize(input.mesh.triangles); ++t) {
        const Corners c = cornersOf(input.mesh, t);
        const Vec3 middle = (1.0 / 3) * (c[0] + c[1] + c[2]);
        const Vec3 inward = -depthMm * normalized(areaVector2(c[0], c[1], c[2]));
        for (const Vec3& corner : {middle, c[0], c[1], c[2]}) {
            if (field.at(0.5 * (middle + corner) + inward) >= 0.5) return;
        }
    }
    refuseNothing(maxErrorMm);
}

/// Nothing is wrong but that there may be borders, and that triangles were turned round.
bool hasBordersAlone(const MendInput& input, const MendStatistics& found) {
    return found.degenerateTriangles == 0 && found.duplicateTriangles == 0 &&
           found.mergedPoints == 0 && found.badEdges == 0 && found.badVertices == 0 &&
           found.crossingTriangles == 0 && !input.oneSidedMm;
}

/// Refuses a hole that is too wide before work begins, where a cap closes it. One that lies within
/// the solid closes nothing.
void requireNarrowCaps(const MendInput& input, const detail::WindingField& field, double boundMm,
                       double maxHoleMm) {
    if (input.capOf.empty()) return;
    const TriangleMesh given = input.given();
    const detail::NearnessProof proof(given, boundMm);
    std::vector<std::uint8_t> isFar(input.mesh.triangles.size());
    for (std::int64_t t = input.firstCap(); t < std::ssize(input.mesh.triangles); ++t) {
        detail::NearnessProof::Result found;
        const Corners c = cornersOf(input.mesh, t);
        proof.prove(c, spacingFor(boundMm) / 4, found);
        if (found.others.empty()) continue;
        const Vec3 middle = 1.0 / 3 * (c[0] + c[1] + c[2]),
                   step = 1e-3 * boundMm * normalized(areaVector2(c[0], c[1], c[2]));
        const bool isWithin = field.at(middle + step) >= 0.5 && field.at(middle - step) >= 0.5;
        isFar[t] = isWithin ? 0 : 1;
    }
    const auto places = detail::connectedPlaces(input.mesh, isFar);
    if (!places.empty() && places[0].first.spanMm > maxHoleMm) {
        refuseHole(places[0].first, maxHoleMm, input);
    }
}

/// Refuses a sheet without a fault but borders, one of which is too wide and has no cap. What
/// closes it is as wide, and has at least the area that the border has seen along its mean normal:
/// more than a crack, which the lattice closes.
void requireNarrowBorders(const MendInput& input, const MendStatistics& found, double boundMm,
                          double maxHoleMm) {
    const auto rings = detail::borderRings(input);
    if (rings.empty() || !hasBordersAlone(input, found)) return;
    if (labelComponents(input.mesh).count != 1) return;
    for (const auto& ring : rings) {
        std::vector<Vec3> points;
        Vec3 area;
        for (const VertexId v : ring) {
            points.push_back(input.mesh.points[v]);
            const Vec3& before = points[std::max<std::size_t>(points.size(), 2) - 2];
            area += 0.5 * cross(before - points[0], points.back() - points[0]);
        }
        const MendedPlace place = borderPlaces(points, [&](const auto& add) {
                                      for (VertexId n = 1; n < std::ssize(points); ++n)
                                          add(n - 1, n);
                                  }).front();
        constexpr double kCells = 4;
        if (place.spanMm - 2 * boundMm > maxHoleMm &&
            norm(area) > kCells * spacingFor(boundMm) * place.spanMm) {
            refuseHole(place, maxHoleMm, input);
        }
    }
}

/// The places where triangles close holes, the widest first.
auto filledPlaces(const MendAssembly& assembly) {
    std::vector<std::uint8_t> isFilled(assembly.source.size());
    for (std::size_t t = 0; t < isFilled.size(); ++t) {
        isFilled[t] = assembly.source[t] == MendSource::Filled ? 1 : 0;
    }
    return detail::connectedPlaces(assembly.mesh, isFilled);
}

/// Lists the holes that were closed; refuses or opens those that are too wide.
void judgeHoles(const MendInput& input, MendAssembly& assembly, double maxHoleMm, bool leavesOpen,
                MendStatistics& statistics) {
    std::vector<std::uint8_t> isOpened(assembly.source.size());
    for (auto& [place, triangles] : filledPlaces(assembly)) {
        if (place.spanMm <= maxHoleMm) {
            statistics.filled.push_back(place);
            continue;
        }
        if (!leavesOpen) {
            refuseHole(place, maxHoleMm, input);
        }
        statistics.leftOpen.push_back(place);
        for (const std::int64_t t : triangles) isOpened[t] = 1;
    }
    if (statistics.leftOpen.empty()) return;
    dropTriangles(assembly, isOpened);
    splitFans(assembly.mesh);
}

/// Cells with new surface, ascending.
std::vector<std::uint64_t> cellsWithSurface(const MendAssembly& assembly) {
    std::vector<std::uint64_t> cells = assembly.cell;
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    return cells;
}

/// Counts the input's triangles that the result has, whole or in part.
void countOrigins(const MendAssembly& assembly, const MendInput& input,
                  MendStatistics& statistics) {
    statistics.keptTriangles = statistics.cutTriangles = 0;
    std::int64_t last = -1 - std::ssize(input.mesh.triangles);  // parts follow each other
    for (std::size_t t = 0; t < assembly.source.size(); ++t) {
        const std::int64_t origin = assembly.origin[t];
        if (origin < 0 || origin >= input.firstCap()) continue;
        const std::int64_t whole = input.partOf.empty() ? -1 : input.partOf[origin];
        const bool isCut = assembly.source[t] == MendSource::Cut || whole >= 0;
        const std::int64_t given = whole >= 0 ? whole : -1 - origin;
        if (!isCut) ++statistics.keptTriangles;
        if (isCut && given != last) ++statistics.cutTriangles;
        last = given;
    }
}

/// Grows the region until the result is sound.
/// \return  false where no growing helps
bool mendIn(MendRegion& region, const MendInput& input, const detail::WindingField& field,
            const MendLattice& lattice, const ProgressCallback& progress, MendAssembly& assembly) {
    for (int round = 0; round < kMostRounds; ++round) {
        region.grow();
        if (progress) progress("mend", (round + 1.0) / (kMostRounds + 1.0));
        assembly = assemble(input, region, field, lattice);
        if (!assembly.trouble.empty()) {
            region.add(assembly.trouble);
            continue;
        }
        bool isSound = false;
        const std::vector<std::uint64_t> cells = cellsOfFaults(assembly, region, isSound);
        if (isSound) return checkTopology(assembly.mesh).isWatertight();
        if (cells.empty()) return false;
        region.add(cells);
    }
    return false;
}

/// Refuses a hole that is too wide by a lattice eight times as coarse.
void rehearse(const MendInput& input, const AabbTree& tree, const detail::WindingField& field,
              const BoundingBox& box, double boundMm, double maxHoleMm) {
    const double roughMm = std::min(8 * boundMm, maxHoleMm / 4);
    const bool isOpen = std::any_of(input.edges.begin(), input.edges.end(),
                                    [](const MendInput::Edge& e) { return !e.isSound; });
    if (!isOpen || roughMm < 2 * boundMm) return;
    const MendLattice lattice(box, spacingFor(roughMm), kShifts[0]);
    MendRegion region(input, tree, field, lattice);
    region.addFaults();
    MendAssembly assembly;
    if (!mendIn(region, input, field, lattice, {}, assembly)) return;
    detail::findBridges(input, lattice, roughMm, assembly);
    const auto places = filledPlaces(assembly);
    if (places.empty() || places[0].first.spanMm <= maxHoleMm + 2 * roughMm) return;
    // narrow holes beside each other may look like one here: a wide one has a border as wide
    const auto borders = borderPlaces(input.mesh.points, [&](const auto& add) {
        for (const auto& ring : detail::borderRings(input)) {
            for (std::size_t n = 0; n < ring.size(); ++n) add(ring[n], ring[(n + 1) % ring.size()]);
        }
    });
    if (borders.empty() || borders[0].spanMm + 4 * roughMm < places[0].first.spanMm) return;
    refuseHole(places[0].first, maxHoleMm, input);
}

/// Removes handles, and counts what that moves.
void makeBalls(MendAssembly& assembly, const BoundingBox& box, MendStatistics& statistics) {
    const auto gone = detail::removeHandles(
        assembly, statistics.maxErrorMm - statistics.inputToResultMm, statistics);
    if (gone.stuckMm) {
        throw InvalidInput("mend: a handle near " + textOf(*gone.stuckMm) +
                           " can't be cut or filled by a flat disc");
    }
    statistics.inputToResultMm += gone.movedMm;
    // points of cut edges are rounded
    statistics.resultToInputMm += 1e-15 * (norm(box.minimum) + norm(box.maximum));
}

double widestHole(const MendOptions& options, const BoundingBox& box) {
    return options.maxHoleMm.value_or(MendOptions::kHoleOfDiagonal * norm(box.size()));
}

/// The borders of a mesh of open sheets without another fault, the widest first. Empty if it is
/// none: it has a closed piece or another fault.
std::vector<MendedPlace> bordersOfSheets(const TriangleMesh& mesh, const MendInput& input,
                                         const MendStatistics& found) {
    if (!hasBordersAlone(input, found) || found.flippedTriangles > 0) return {};
    if (!checkTopology(mesh).isManifold()) return {};  // holes share corners
    const ComponentLabels pieces = labelComponents(mesh);
    std::vector<std::uint8_t> isOpen(pieces.count);
    for (const auto& [a, b] : input.borders) isOpen[pieces.ofVertex[a]] = 1;
    const auto isClosed = [&](const Triangle& t) { return isOpen[pieces.ofVertex[t[0]]] == 0; };
    if (std::any_of(mesh.triangles.begin(), mesh.triangles.end(), isClosed)) return {};
    return borderPlaces(mesh.points, [&](const auto& add) {
        for (const auto& [a, b] : input.borders) add(a, b);
    });
}

/// The triangles of pieces that are not wanted; empty where there are none.
std::vector<std::uint8_t> unwanted(const TriangleMesh& mesh, const ComponentSelection& pieces) {
    if (pieces.keepsAll()) return {};
    std::vector<std::uint8_t> marks = keptTriangles(mesh, pieces);
    for (std::uint8_t& mark : marks) mark = mark == 0 ? 1 : 0;
    if (std::find(marks.begin(), marks.end(), 1) == marks.end()) marks.clear();
    return marks;
}

/// Drops pieces that are not wanted, and counts again what is left.
void dropPieces(const MendInput& input, const ComponentSelection& pieces, MendAssembly& assembly,
                MendStatistics& statistics) {
    const std::vector<std::uint8_t> isDropped = unwanted(assembly.mesh, pieces);
    if (isDropped.empty()) return;
    for (auto& piece : detail::connectedPlaces(assembly.mesh, isDropped)) {
        statistics.droppedPieces.push_back(piece.first);
    }
    dropTriangles(assembly, isDropped);
    if (assembly.mesh.triangles.empty()) {
        throw InvalidInput("mend: no piece has minVolumeMm3 of material");
    }
    countOrigins(assembly, input, statistics);
    statistics.filled.clear();
    for (auto& hole : filledPlaces(assembly)) statistics.filled.push_back(hole.first);
}

/// mend() of a prepared input. `statistics` holds what was found.
TriangleMesh mendPrepared(const TriangleMesh& mesh, const MendInput& input, const BoundingBox& box,
                          const MendOptions& options, MendStatistics& statistics) {
    if (input.oneSidedMm) {
        throw InvalidInput("mend: the surface is one-sided, as a Moebius band, near " +
                           textOf(*input.oneSidedMm) + ", so it has no inside");
    }
    const AabbTree tree(input.mesh);
    const detail::WindingField field(input.mesh, tree);
    constexpr double kPartBesidesHandles = 0.75;
    const double boundMm = (options.removesHandles ? kPartBesidesHandles : 1) *
                           (statistics.maxErrorMm - statistics.movedMm);
    const double maxHoleMm = widestHole(options, box);
    requireVolume(input, field, boundMm, statistics.maxErrorMm);
    if (!options.leavesHolesOpen) {
        requireNarrowCaps(input, field, boundMm, maxHoleMm);
        requireNarrowBorders(input, statistics, boundMm, maxHoleMm);
        rehearse(input, tree, field, box, boundMm, maxHoleMm);
    }
    for (std::size_t attempt = 0; attempt < kShifts.size(); ++attempt) {
        const MendLattice lattice(box, spacingFor(boundMm), kShifts[attempt]);
        MendRegion region(input, tree, field, lattice);
        region.addFaults();
        MendAssembly assembly;
        if (!mendIn(region, input, field, lattice, options.progress, assembly)) continue;
        dropCrumbs(assembly, lattice.spacing());
        statistics.filled.clear();
        statistics.leftOpen.clear();
        if (assembly.mesh.triangles.empty()) refuseNothing(statistics.maxErrorMm);
        statistics.cells = std::ssize(region.cells());
        statistics.latticeMm = region.isEmpty() ? 0 : lattice.spacing();
        countOrigins(assembly, input, statistics);
        if (options.removesHandles) {
            statistics.handles = checkTopology(assembly.mesh).genus().value_or(0);
        }
        if (region.isEmpty() && assembly.mesh.triangles.size() == mesh.triangles.size() &&
            assembly.mesh.points.size() == mesh.points.size() &&
            input.mesh.triangles == mesh.triangles && statistics.handles == 0 &&
            unwanted(mesh, options.pieces).empty()) {
            statistics.wasSound = true;
            return mesh;
        }
        const double thinMm = 0.99 * (boundMm - std::sqrt(3.0) * lattice.spacing());
        findBridges(input, lattice, boundMm - thinMm, assembly);
        const std::vector<std::uint64_t> cells = cellsWithSurface(assembly);
        detail::thin(tree, thinMm, assembly);
        judgeHoles(input, assembly, maxHoleMm, options.leavesHolesOpen, statistics);
        detail::proveDistances(input, tree, field, region, lattice, cells, assembly, boundMm,
                               statistics);
        if (std::max(statistics.resultToInputMm, statistics.inputToResultMm) >
            statistics.maxErrorMm) {
            continue;
        }
        if (options.removesHandles) {
            makeBalls(assembly, box, statistics);
            countOrigins(assembly, input, statistics);
        }
        dropPieces(input, options.pieces, assembly, statistics);
        if (options.progress) options.progress("mend", 1);
        return std::move(assembly.mesh);
    }
    throw InvalidInput("mend: could not be mended within " + formatShort(statistics.maxErrorMm) +
                       " mm");
}

/// mendPrepared(), with crossing triangles cut first where that can be done.
TriangleMesh mendCut(const TriangleMesh& mesh, const MendInput& input, const BoundingBox& box,
                     const MendOptions& options, MendStatistics& statistics) {
    MendStatistics found = statistics;
    if (const auto cut = detail::cutCrossings(input, box, found)) {
        try {
            TriangleMesh mended = mendPrepared(mesh, *cut, box, options, found);
            statistics = std::move(found);
            return mended;
        } catch (const InvalidInput&) {  // next: the surface as given, by the lattice alone
        }
    }
    return mendPrepared(mesh, input, box, options, statistics);
}

bool isUsable(const TriangleMesh& mesh, const Triangle& triangle) {
    return std::ranges::all_of(triangle, [&](VertexId v) {
        return v >= 0 && v < std::ssize(mesh.points) && isFinite(mesh.points[v]);
    });
}

/// mend() of a mesh that isBroken().
Mended mendBroken(TriangleMesh mesh, const MendOptions& options) {
    const std::int64_t dropped = dropBrokenTriangles(mesh);
    if (mesh.triangles.empty()) {
        throw InvalidInput("mend: every triangle names a point that is not there or not finite");
    }
    try {
        Mended result = mend(mesh, options);
        result.statistics.brokenTriangles = dropped;
        if (result.statistics.wasSound) {
            result.statistics.wasSound = false;
            result.mesh = withoutUnusedPoints(std::move(result.mesh));
            result.mesh.normals.clear();
        }
        return result;
    } catch (MendRefusal& refusal) {
        refusal.statistics.brokenTriangles = dropped;
        throw;
    }
}

}  // namespace

bool isBroken(const TriangleMesh& mesh) {
    return !std::ranges::all_of(mesh.points, [](const Vec3& p) { return isFinite(p); }) ||
           !std::ranges::all_of(mesh.triangles,
                                [&](const Triangle& t) { return isUsable(mesh, t); });
}

std::int64_t dropBrokenTriangles(TriangleMesh& mesh) {
    const auto dropped =
        std::erase_if(mesh.triangles, [&](const Triangle& t) { return !isUsable(mesh, t); });
    const Vec3 there = mesh.triangles.empty() ? Vec3{} : mesh.points[mesh.triangles[0][0]];
    for (Vec3& p : mesh.points) {
        if (!isFinite(p)) p = there;
    }
    mesh.normals.clear();
    return static_cast<std::int64_t>(dropped);
}

Mended mend(const TriangleMesh& mesh, const MendOptions& options) {
    if (mesh.triangles.empty()) throw InvalidInput("mend: the mesh has no triangle");
    if (isBroken(mesh)) return mendBroken(mesh, options);
    detail::requireCountable(mesh);
    BoundingBox box = BoundingBox::empty();  // of points that are used
    for (std::int64_t t = 0; t < std::ssize(mesh.triangles); ++t)
        box.add(boxOf(cornersOf(mesh, t)));
    const double diagonal = norm(box.size());
    Mended result;
    result.statistics.maxErrorMm = checkedBound(options, diagonal);
    requireDigits(box, diagonal, result.statistics.maxErrorMm);
    const MendInput input = detail::prepareInput(mesh, result.statistics);
    if (options.leavesHolesOpen) {
        auto borders = bordersOfSheets(mesh, input, result.statistics);
        if (!borders.empty() && borders.back().spanMm > widestHole(options, box)) {
            result.statistics.leftOpen = std::move(borders);
            result.mesh = withoutUnusedPoints(mesh);
            result.statistics.wasSound = result.mesh.points.size() == mesh.points.size();
            if (!result.statistics.wasSound) result.mesh.normals.clear();
            result.statistics.keptTriangles = std::ssize(mesh.triangles);
            return result;
        }
    }
    try {
        result.mesh = mendCut(mesh, input, box, options, result.statistics);
    } catch (const InvalidInput& refusal) {
        throw MendRefusal(refusal.what(), std::move(result.statistics));
    }
    return result;
}

}  // namespace adaptiso
