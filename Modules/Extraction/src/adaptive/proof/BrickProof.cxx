#include "adaptive/proof/BrickProof.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "adaptive/Parameters.h"

namespace adaptiso::detail {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr int kCells = Brick::kSide + 2 * BrickMesher::kHalo;

/// Where a cell is remembered, by its place in the brick.
std::size_t cellSlot(int x, int y, int z) {
    constexpr int kHalo = BrickMesher::kHalo;
    return static_cast<std::size_t>(x + kHalo + kCells * (y + kHalo + kCells * (z + kHalo)));
}

}  // namespace

bool ProofScope::isNearWanted(std::uint32_t block, const BlockGrid& grid) const {
    if (blocks.empty()) return true;
    const std::int64_t reach = (BrickMesher::kHalo + grid.blockSize - 1) / grid.blockSize;
    std::array<std::int64_t, 3> first{}, last{};
    std::int64_t rest = block;
    for (int a = 0; a < 3; ++a) {
        const std::int64_t at = rest % grid.blocks[a];
        rest /= grid.blocks[a];
        first[a] = std::max<std::int64_t>(at - reach, 0);
        last[a] = std::min(at + reach, grid.blocks[a] - 1);
    }
    for (std::int64_t z = first[2]; z <= last[2]; ++z) {
        for (std::int64_t y = first[1]; y <= last[1]; ++y) {
            const std::int64_t row = grid.blocks[0] * (y + grid.blocks[1] * z);
            for (std::int64_t x = first[0]; x <= last[0]; ++x) {
                if (blocks[row + x]) return true;
            }
        }
    }
    return false;
}

BrickProof::BrickProof(const SimplifiedSurface& surface, const SurfaceLookup& lookup,
                       const WholeBricks& whole, const LatticeSampler& sampler,
                       const ProofScope& scope, SampleNumbers& numbers, double enoughMm,
                       double limitMm)
    : surface_(surface),
      lookup_(lookup),
      whole_(whole),
      frame_(lookup.frame()),
      scope_(scope),
      numbers_(numbers),
      enoughMm_(enoughMm),
      limitMm_(limitMm),
      mesher_(sampler, lookup.bricks().grid()),
      cellAt_(std::size_t{kCells} * kCells * kCells),
      map_(lookup.walkable(), enoughMm * enoughMm),
      cover_(lookup.walkable(), lookup.triangleCount()) {}

BrickBound BrickProof::prove(std::int64_t brick) {
    brick_ = brick;
    if (isIdle()) return {};
    low_ = lookup_.bricks()[brick].low;
    if (const auto bound = boundOfWhole()) return *bound;
    const BlockGrid& grid = lookup_.bricks().grid();
    mesher_.meshWithHalo(
        lookup_.bricks(), brick,
        [&](std::uint32_t block) { return scope_.isNearWanted(block, grid); }, fine_);
    points_.resize(fine_.vertices.size());
    for (std::size_t v = 0; v < points_.size(); ++v) {
        points_[v] = frame_.fromIndex(fine_.vertices[v].index);
    }
    walkable_.assign(points_, fine_.triangles);
    result_ = {};
    boxes_.clear();
    fromFine_ = toFine_ = PieceBound(enoughMm_);
    proveOwnCells();
    proveTriangles();
    result_.provedMm = std::max(fromFine_.boundMm(), toFine_.boundMm());
    return std::move(result_);
}

/// Nothing in the brick is to be proved.
bool BrickProof::isIdle() const {
    const auto& blocks = lookup_.bricks()[brick_].blocks;
    const auto triangles = lookup_.ofBrick(brick_);
    return std::none_of(blocks.begin(), blocks.end(),
                        [&](std::uint32_t block) { return scope_.isWanted(block); }) &&
           std::all_of(triangles.begin(), triangles.end(),
                       [&](Number t) { return scope_.isProved(t); });
}

/// Of a brick in which both surfaces are the same, if it does not answer for triangles that come
/// from elsewhere.
std::optional<BrickBound> BrickProof::boundOfWhole() {
    if (!whole_.isWhole(brick_)) return {};
    BrickBound bound;
    bool isAll = true;
    for (const Number t : lookup_.ofBrick(brick_)) {
        if (scope_.isProved(t)) continue;
        const Corners corners = lookup_.cornersOf(t);
        forEachPieceHere(corners, norm(areaVector2(corners[0], corners[1], corners[2])),
                         [&](const Corners&, double area2) {
                             isAll = isAll && whole_.isFine(t);
                             bound.provedArea += 0.5 * area2;
                         });
    }
    return isAll ? std::optional(bound) : std::nullopt;
}

/// The full-resolution surface in the brick's own cells.
void BrickProof::proveOwnCells() {
    findAssigned();
    findUnmoved();
    unchanged_.clear();
    map_.clear();
    mapped_.assign(fine_.ownVertices, {{}, {}, 0, -1});
    ways_.assign(3 * fine_.ownTriangles, {});
    isMapped_.assign(fine_.ownTriangles, 0);
    const auto& cells = fine_.cells;
    for (std::size_t c = 0; c < cells.size(); ++c) {
        if (cells[c].firstTriangle >= fine_.ownTriangles) break;
        if (!scope_.isWanted(blockOf(cells[c]))) continue;
        const std::size_t end =
            c + 1 < cells.size() ? cells[c + 1].firstTriangle : fine_.triangles.size();
        for (std::size_t t = cells[c].firstTriangle; t < end; ++t) proveFine(t);
    }
    findCovered();
    std::sort(unchanged_.begin(), unchanged_.end());
}

std::uint64_t BrickProof::blockOf(const FineSurface::Cell& cell) const {
    const BlockGrid& grid = lookup_.bricks().grid();
    const auto at = [&](int a) { return (low_[a] + cell.position[a]) / grid.blockSize; };
    return static_cast<std::uint64_t>(at(0) + grid.blocks[0] * (at(1) + grid.blocks[1] * at(2)));
}

/// The pieces of the simplified surface that the brick answers for.
void BrickProof::proveTriangles() {
    rememberCells();
    const auto triangles = lookup_.ofBrick(brick_);
    findStarts(triangles);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        triangle_ = triangles[i];
        if (scope_.isProved(triangle_)) continue;
        const Corners corners = lookup_.cornersOf(triangle_);
        forEachPieceHere(
            corners, norm(areaVector2(corners[0], corners[1], corners[2])),
            [&](const Corners& piece, double area2) {
                result_.provedArea += 0.5 * area2;
                if (!cover_.covers(triangle_) &&
                    !std::binary_search(unchanged_.begin(), unchanged_.end(), triangle_)) {
                    proveWhole(piece, startAt_[i], area2);
                }
            });
    }
    forgetCells();
    cover_.clear();
}

/// Triangles that vertices are assigned to, by their places: of a brick that was left whole there
/// are no samples. Where a vertex has gone, the nearest of the brick's.
void BrickProof::findAssignedByPlace() {
    std::unordered_map<std::uint64_t, Number> at;
    for (const Number t : lookup_.ofBrick(brick_)) {
        for (const Vec3& corner : lookup_.cornersOf(t)) {
            at.try_emplace(BrickPrint::printOf(corner), t);
        }
    }
    const auto nearest = [&](const Vec3& p) {
        std::pair best{kInfinity, kNone};
        for (const Number t : lookup_.ofBrick(brick_)) {
            best = std::min(best, {squaredDistanceToTriangle(p, lookup_.cornersOf(t)), t});
        }
        return best.second;
    };
    assigned_.resize(fine_.ownVertices);
    for (std::size_t v = 0; v < fine_.ownVertices; ++v) {
        const auto found = at.find(BrickPrint::printOf(points_[v]));
        assigned_[v] = found != at.end() ? found->second : nearest(points_[v]);
    }
}

void BrickProof::findAssigned() {
    if (surface_.wasLeftWhole(brick_)) {
        findAssignedByPlace();
        return;
    }
    if (scope_.blocks.empty()) {
        numbers_.ofWhole(brick_, fine_, numberOf_);
    } else {
        numbers_.ofPart(brick_, fine_, numberOf_);
    }
    const auto triangles = std::span(surface_.sampleTriangle);
    const auto within = triangles.subspan(surface_.firstSample[brick_]),
               onWalls = triangles.subspan(surface_.firstSample.back());
    const auto& edges = surface_.wallEdges;
    assigned_.assign(fine_.ownVertices, kNone);
    for (std::size_t v = 0; v < fine_.ownVertices; ++v) {
        if (fine_.vertices[v].isOnWall) {
            const std::uint64_t edge = fine_.vertices[v].edge.word;
            assigned_[v] =
                onWalls[std::lower_bound(edges.begin(), edges.end(), edge) - edges.begin()];
        } else if (numberOf_[v] != SampleNumbers::kNone) {
            assigned_[v] = within[numberOf_[v]];
        }
    }
}

void BrickProof::findUnmoved() {
    unmoved_.assign(fine_.ownVertices, kNone);
    for (std::size_t v = 0; v < fine_.ownVertices; ++v) {
        if (assigned_[v] == kNone) continue;
        for (const Number corner : lookup_.triangle(assigned_[v])) {
            if (lookup_.point(corner) == points_[v]) unmoved_[v] = corner;
        }
    }
}

/// The fine triangle is a triangle of the simplified surface as well.
bool BrickProof::isUnchanged(const std::array<std::uint32_t, 3>& fine) {
    const Number a = unmoved_[fine[0]], b = unmoved_[fine[1]], c = unmoved_[fine[2]];
    if (a == kNone || b == kNone || c == kNone) return false;
    const Number t = lookup_.walkable().find(a, b, c);
    if (t == kNone) return false;
    unchanged_.push_back(t);
    return true;
}

/// For every triangle of the simplified surface a fine one with a corner assigned to it, or none.
void BrickProof::findStarts(std::span<const Number> triangles) {
    startAt_.assign(triangles.size(), Walkable::kNone);
    for (std::uint32_t v = 0; v < fine_.ownVertices; ++v) {
        if (assigned_[v] == kNone) continue;
        const auto at = std::lower_bound(triangles.begin(), triangles.end(), assigned_[v]);
        if (at != triangles.end() && *at == assigned_[v]) {
            startAt_[at - triangles.begin()] = walkable_.triangleAt(v);
        }
    }
}

void BrickProof::rememberCells() {
    for (std::uint32_t c = 0; c < fine_.cells.size(); ++c) {
        const auto& p = fine_.cells[c].position;
        cellAt_[cellSlot(p[0], p[1], p[2])] = c + 1;
    }
    fine_.cells.push_back({{0, 0, 0}, static_cast<std::uint32_t>(fine_.triangles.size())});
}

void BrickProof::forgetCells() {
    fine_.cells.pop_back();
    for (const auto& cell : fine_.cells) {
        cellAt_[cellSlot(cell.position[0], cell.position[1], cell.position[2])] = 0;
    }
}

/// \return false when the triangle could not be mapped within the bound so far
bool BrickProof::mapFine(std::uint32_t t) {
    const auto& v = fine_.triangles[t];
    const std::array corners{mappedVertex(v[0]), mappedVertex(v[1]), mappedVertex(v[2])};
    std::array<Map::Side, 3> sides;
    for (std::uint32_t i = 0; i < 3; ++i) {
        sides[i] = sideOf(3 * t + i, *corners[i], *corners[(i + 1) % 3]);
    }
    if (!map_.map(corners, sides, fromFine_.squaredBound())) return false;
    isMapped_[t] = 1;
    for (const Map::Part& part : map_.parts()) cover_.add(part);
    return true;
}

const BrickProof::Map::Vertex* BrickProof::mappedVertex(std::uint32_t v) {
    if (mapped_[v].squared < 0) {
        mapped_[v] = map_.vertexAt(points_[v], assigned_[v]);
    }
    return &mapped_[v];
}

/// The first of the half-edges along an edge.
std::uint32_t BrickProof::edgeOf(std::uint32_t halfEdge) const {
    return std::min(halfEdge, walkable_.twin(halfEdge));
}

/// \param a  where the half-edge begins \param b  where it ends
BrickProof::Map::Side BrickProof::sideOf(std::uint32_t halfEdge, const Map::Vertex& a,
                                         const Map::Vertex& b) {
    if (a.imageTriangle == b.imageTriangle) return {nullptr, true};
    const std::uint32_t edge = edgeOf(halfEdge);
    const bool isForward = edge == halfEdge;
    Map::Way& way = ways_[edge];
    if (!way.isKnown()) way = isForward ? map_.wayAlong(a, b) : map_.wayAlong(b, a);
    return {&way, isForward};
}

/// Tells the cover of the border between triangles that are mapped and others.
void BrickProof::findCovered() {
    const auto passes = [&](Number triangle) { cover_.addBorder(triangle); };
    for (std::uint32_t h = 0; h < 3 * isMapped_.size(); ++h) {
        const std::uint32_t beside = walkable_.twin(h) / 3;
        if (isMapped_[h / 3] == 0 || (beside < isMapped_.size() && isMapped_[beside] != 0))
            continue;
        passes(mapped_[fine_.triangles[h / 3][h % 3]].imageTriangle);
        map_.forEachAlong(ways_[edgeOf(h)], passes);
    }
}

void BrickProof::proveFine(std::size_t t) {
    const auto& v = fine_.triangles[t];
    if (isUnchanged(v) || mapFine(static_cast<std::uint32_t>(t))) return;
    const Corners piece{points_[v[0]], points_[v[1]], points_[v[2]]};
    cover(piece, lookup_.walkable(), assigned_[v[0]], fromFine_.squaredBound(), kStepsOfFine);
    for (const ConvexPiece& left : walk_.left()) {
        for (int i = 2; i < left.count(); ++i) {
            proveFinePart({left.corner(0), left.corner(i - 1), left.corner(i)}, v);
        }
    }
}

/// \param of  the fine triangle that it is a part of
void BrickProof::proveFinePart(const Corners& piece, const std::array<std::uint32_t, 3>& of) {
    std::vector<Corners>& nearby = fromFine_.nearby();
    nearby.clear();
    for (const std::uint32_t corner : of) nearby.push_back(lookup_.cornersOf(assigned_[corner]));
    if (fromFine_.isWithin(piece)) return;
    collectAround(of);
    if (fromFine_.isWithin(piece)) return;
    // all that can be nearer than what the corners are known to be
    double reachMm = fromFine_.boundMm();
    for (const Vec3& corner : piece) {
        double nearest = kInfinity;
        for (const Corners& stand : nearby) {
            nearest = std::min(nearest, squaredDistanceToTriangle(corner, stand));
        }
        reachMm = std::max(reachMm, std::sqrt(nearest));
    }
    collectWithin(reachMm, piece);
    const std::optional<FarPoint> far =
        fromFine_.includeWithin(limitMm_, piece, result_.farthestMm);
    if (!far) return;
    const Number t = far->hasNearest ? within_[far->nearest] : PlaceBeyond::kNone;
    result_.beyondLimit.push_back({far->onOther, far->point, t, true});
}

/// The triangles that share corners with those that a fine triangle's corners are assigned to.
void BrickProof::collectAround(const std::array<std::uint32_t, 3>& fine) {
    around_.clear();
    for (const std::uint32_t corner : fine) {
        for (const Number v : lookup_.triangle(assigned_[corner])) {
            lookup_.walkable().forEachAt(v, [&](Number t) { around_.push_back(t); });
        }
    }
    std::sort(around_.begin(), around_.end());
    around_.erase(std::unique(around_.begin(), around_.end()), around_.end());
    fromFine_.nearby().clear();
    for (const Number t : around_) fromFine_.nearby().push_back(lookup_.cornersOf(t));
}

/// The triangles that may lie within a distance of a part of a fine triangle.
void BrickProof::collectWithin(double distanceMm, const Corners& piece) {
    std::vector<Corners>& nearby = fromFine_.nearby();
    nearby.clear();
    within_.clear();
    const auto add = [&](Number t) {
        nearby.push_back(lookup_.cornersOf(t));
        within_.push_back(t);
    };
    if (!lookup_.ofBrickHasAllWithin(distanceMm)) {
        lookup_.forEachNear(piece, distanceMm, add);
        return;
    }
    const auto triangles = lookup_.ofBrick(brick_);
    if (boxes_.isEmpty()) {
        for (const Number t : triangles) boxes_.add(boxOf(lookup_.cornersOf(t)));
    }
    BoundingBox box = boxOf(piece);
    box.widen(distanceMm);
    boxes_.forEachOverlap(box, [&](std::size_t i) { add(triangles[i]); });
}

/// Calls f(piece, area2) for the pieces of a triangle of the simplified surface that this brick
/// answers for.
/// \param area2  twice the piece's area
template <class F>
void BrickProof::forEachPieceHere(const Corners& piece, double area2, const F& f) const {
    const BoundingBox box = latticeBox(piece);
    constexpr double kMargin = BrickMesher::kHalo / 2.0;
    for (int a = 0; a < 3; ++a) {
        if (box.maximum[a] < -kMargin || box.minimum[a] > Brick::kSide + kMargin) return;
    }
    const Vec3 middle = (1.0 / 3) * (piece[0] + piece[1] + piece[2]);
    const std::int64_t brick = lookup_.brickFor(lookup_.latticeOf(middle));
    if (lookup_.isSmall(piece) || (brick != Bricks::kNone && lookup_.isWithinReach(brick, piece))) {
        if (brick == brick_) f(piece, area2);
        return;
    }
    for (const Corners& part : quarter(piece)) forEachPieceHere(part, area2 / 4, f);
}

void BrickProof::proveWhole(const Corners& piece, std::uint32_t start, double area2) {
    if (start == Walkable::kNone) start = nearestFine(piece[0]);
    if (start == Walkable::kNone) {
        proveSmall(piece);
        return;
    }
    const double faces = area2 / (frame_.narrowestMm() * frame_.narrowestMm());
    const int steps = kFewSteps + static_cast<int>(std::min(kManySteps, kStepsPerFace * faces));
    cover(piece, walkable_, start, toFine_.squaredBound(), steps);
    for (const ConvexPiece& left : walk_.left()) {
        for (int i = 2; i < left.count(); ++i) {
            proveSmall({left.corner(0), left.corner(i - 1), left.corner(i)});
        }
    }
}

template <class Index>
void BrickProof::cover(const Corners& piece, const WalkableSurface<Index>& surface, Index start,
                       double squaredDistance, int steps) {
    const double loose = kLooseBound * frame_.voxelMm();
    if (squaredDistance > loose * loose) {
        walk_.coverLoosely(piece, surface, start, squaredDistance, steps);
    } else {
        walk_.cover(ConvexPiece(piece), surface, start, squaredDistance, steps);
    }
}

void BrickProof::proveSmall(const Corners& piece) {
    if (lookup_.isSmall(piece)) {
        proveLeaf(piece, latticeBox(piece));
        return;
    }
    for (const Corners& part : quarter(piece)) proveSmall(part);
}

void BrickProof::proveLeaf(const Corners& piece, const BoundingBox& box) {
    const auto use = [&] {
        toFine_.nearby().clear();
        for (const std::uint32_t t : near_) toFine_.nearby().push_back(walkable_.cornersOf(t));
    };
    collectNear(box, 0.5);
    keepNearest(piece);
    use();
    if (!near_.empty() && toFine_.isWithin(piece, toFine_.nearby().front())) return;
    if (toFine_.isWithin(piece)) return;
    for (double reach = 1.5;; reach *= 2) {  // mostly once
        collectNear(box, reach);
        if (!near_.empty() || reach > kCells) break;
    }
    use();
    const std::optional<FarPoint> far = toFine_.includeWithin(limitMm_, piece, result_.farthestMm);
    if (far) result_.beyondLimit.push_back({far->point, far->onOther, triangle_, false});
}

/// In cells, seen from the brick's first.
BoundingBox BrickProof::latticeBox(const Corners& piece) const {
    const Vec3 low{static_cast<double>(low_[0]), static_cast<double>(low_[1]),
                   static_cast<double>(low_[2])};
    return boxOf({lookup_.latticeOf(piece[0]) - low, lookup_.latticeOf(piece[1]) - low,
                  lookup_.latticeOf(piece[2]) - low});
}

std::uint32_t BrickProof::nearestFine(const Vec3& p) {
    const BoundingBox box = latticeBox({p, p, p});
    std::uint32_t best = Walkable::kNone;
    double least = kInfinity;
    for (double reach = 0.5; reach < 2 && best == Walkable::kNone; ++reach) {
        collectNear(box, reach);
        for (const std::uint32_t t : near_) {
            const double squared = squaredDistanceToTriangle(p, walkable_.cornersOf(t));
            if (squared < least) {
                least = squared;
                best = t;
            }
        }
    }
    return best;
}

/// The fine triangles in the cells up to `reach` around a box.
void BrickProof::collectNear(const BoundingBox& box, double reach) {
    near_.clear();
    std::array<int, 3> first{}, last{};
    for (int a = 0; a < 3; ++a) {
        constexpr int kHalo = BrickMesher::kHalo;
        first[a] = std::max(-kHalo, static_cast<int>(std::floor(box.minimum[a] - reach)));
        last[a] = std::min(Brick::kSide + kHalo - 1,
                           static_cast<int>(std::floor(box.maximum[a] + reach)));
    }
    for (int z = first[2]; z <= last[2]; ++z) {
        for (int y = first[1]; y <= last[1]; ++y) {
            for (int x = first[0]; x <= last[0]; ++x) {
                const std::uint32_t cell = cellAt_[cellSlot(x, y, z)];
                if (cell == 0) continue;
                for (std::uint32_t t = fine_.cells[cell - 1].firstTriangle;
                     t < fine_.cells[cell].firstTriangle; ++t) {
                    near_.push_back(t);
                }
            }
        }
    }
}

/// Of the fine triangles near a piece, keeps the few whose middles are nearest: nearly every piece
/// lies near one of them.
void BrickProof::keepNearest(const Corners& piece) {
    if (near_.size() <= kNearestFine) return;
    const Vec3 middle = piece[0] + piece[1] + piece[2];
    ranked_.clear();
    for (const std::uint32_t t : near_) {
        const Corners c = walkable_.cornersOf(t);
        ranked_.emplace_back(squaredNorm(c[0] + c[1] + c[2] - middle), t);
    }
    std::partial_sort(ranked_.begin(), ranked_.begin() + kNearestFine, ranked_.end());
    near_.resize(kNearestFine);
    for (std::size_t i = 0; i < kNearestFine; ++i) near_[i] = ranked_[i].second;
}

}  // namespace adaptiso::detail
