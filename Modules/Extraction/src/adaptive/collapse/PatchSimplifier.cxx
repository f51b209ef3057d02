#include "adaptive/collapse/PatchSimplifier.h"

#include <algorithm>

#include "adaptive/Parameters.h"

namespace adaptiso::detail {
PatchSimplifier::PatchSimplifier(Patch& patch, const MetricFrame& frame, const PatchLimits& limits)
    : patch_(patch),
      frame_(frame),
      limits_(limits),
      topology_(patch),
      errors_(patch, frame),
      guard_(patch, topology_, frame, limits.provesAll),
      tried_(patch.states, limits.triedCost) {}

QuadricMinimum PatchSimplifier::bestPlace(std::uint32_t a, std::uint32_t b) const {
    const Quadric sum = patch_.quadrics[a] + patch_.quadrics[b];
    const Vec3 &p = patch_.points[a], &q = patch_.points[b];
    const bool endsAtA = topology_.isOnBorder(a), endsAtB = topology_.isOnBorder(b);
    if (!endsAtA && !endsAtB) return minimize(sum, 0.5 * (p + q), kPlaceStiffness);
    // vertices of a border stay vertices of the border that it was
    const double atA = std::max(sum.at(p), 0.0), atB = std::max(sum.at(q), 0.0);
    return endsAtA && (!endsAtB || atA <= atB) ? QuadricMinimum{p, atA} : QuadricMinimum{q, atB};
}

double PatchSimplifier::costOf(std::uint32_t halfEdge) const {
    const std::uint32_t a = topology_.from(halfEdge), b = topology_.to(halfEdge);
    if (!mayChange(a) || !mayChange(b)) return CollapseQueue::kNever;
    const double weight = patch_.quadrics[a].weight() + patch_.quadrics[b].weight();
    const double error = bestPlace(a, b).error;
    if (error > weight * limits_.maxDistanceMm * limits_.maxDistanceMm)
        return CollapseQueue::kNever;
    const double cost =
        error + kLengthWeight * weight * squaredNorm(patch_.points[b] - patch_.points[a]);
    return cost > limits_.maxCost ? CollapseQueue::kNever : cost;
}

Refusal PatchSimplifier::evaluateCollapse(std::uint32_t halfEdge) {
    Change& change = change_;
    if (!topology_.starOfEdge(halfEdge, change.star.star)) return Refusal::Topology;
    change.vertex = topology_.from(halfEdge);
    change.halfEdge = halfEdge;
    change.star.vertex = bestPlace(change.vertex, topology_.to(halfEdge)).point;
    if (!isInBox(change.star.vertex)) {
        passOn(halfEdge);
        return Refusal::OutsideBox;
    }
    const Refusal refusal = shapeOrDistance(change);
    return refusal == Refusal::None && !crossesNothing(change) ? Refusal::Crossing : refusal;
}

bool PatchSimplifier::evaluateFit(std::uint32_t vertex) {
    Change& change = change_;
    if (topology_.isOnBorder(vertex) || !topology_.starOf(vertex, change.star.star)) return false;
    change.vertex = vertex;
    change.halfEdge = PatchTopology::kNone;
    change.star.vertex = patch_.points[vertex];
    if (shapeStar(patch_, limits_.shape, change.star) != Refusal::None) return false;
    const std::optional<StarFit> before = errors_.measure(change.star);
    if (!before) return false;
    const Quadric& quadric = patch_.quadrics[vertex];
    const double mostError = quadric.weight() * limits_.maxDistanceMm * limits_.maxDistanceMm,
                 farthest =
                     std::max(before->largestSquare, limits_.maxFittedMm * limits_.maxFittedMm);
    change.star.vertex = fittedPlace(change.star, quadric);
    return quadric.at(change.star.vertex) <= mostError && isInBox(change.star.vertex) &&
           shapeOrDistance(change) == Refusal::None &&
           change.samples.sumOfSquares < before->sumOfSquares &&
           change.samples.largestSquare <= farthest && crossesNothing(change);
}

void PatchSimplifier::apply(const Change& change) {
    if (change.halfEdge != PatchTopology::kNone) {
        const std::uint32_t other = topology_.to(change.halfEdge);
        topology_.collapse(change.halfEdge, change.star.star);
        const Star& star = change.star.star;
        for (int i = 0; i < star.ringCount(); ++i) tried_.open(star.ring[i]);
        tried_.open(change.vertex);
        patch_.quadrics[change.vertex] += patch_.quadrics[other];
        if (change.star.star.isOpen) patch_.marks[change.vertex] = Patch::kBorder;
        if (!patch_.heirs.empty()) patch_.heirs[other] = change.vertex;
    }
    errors_.commit(change.star, change.samples);
    guard_.commit(change.star, change.samples.isInSingleSheet());
    patch_.points[change.vertex] = change.star.vertex;
}

void PatchSimplifier::collapseEdges(std::int64_t most, std::vector<double>* costs) {
    CollapseQueue queue(topology_, patch_);
    queue.fill(patch_, [&](std::uint32_t h) {
        if (topology_.isMovable(topology_.from(h)) != topology_.isMovable(topology_.to(h)))
            passOn(h);
        const double cost = costOf(h);
        return tried_.has(topology_.from(h), topology_.to(h), cost) ? CollapseQueue::kNever : cost;
    });
    for (std::uint32_t v = 0; v < patch_.points.size(); ++v) {
        if (topology_.isMovable(v)) tried_.begin(v);
    }
    for (std::int64_t made = 0; made < most;) {
        const CollapseQueue::Edge edge = queue.cheapest();
        if (edge.halfEdge == CollapseQueue::kNone) break;
        if (evaluateCollapse(edge.halfEdge) != Refusal::None) {
            queue.refuse(edge.halfEdge);
            continue;
        }
        apply(change_);
        ++made;
        if (costs != nullptr) costs->push_back(edge.cost);
        queue.update(change_.vertex, change_.star.star, [&](std::uint32_t h) { return costOf(h); });
    }
    queue.forEachLeft([&](std::uint32_t h) { passOn(h); });
    tried_.finish();
}

/// The reason to refuse the star: its shape, or its distance from the full-resolution surface.
Refusal PatchSimplifier::shapeOrDistance(Change& change) const {
    const Refusal refusal = shapeStar(patch_, limits_.shape, change.star);
    if (refusal != Refusal::None) return refusal;
    if (turnsOver(change)) return Refusal::InsideOut;
    return errors_.assign(change.star, limits_.maxDistanceMm, change.samples);
}

/// The star and one more triangle are all of a piece, and would be inside out: a bent sheet can
/// become a tetrahedron on its other side with no triangle turning far.
bool PatchSimplifier::turnsOver(const Change& change) const {
    const Star& star = change.star.star;
    if (star.count != 3 || star.isOpen) return false;
    std::array<std::uint32_t, 3> opposite;
    for (int i = 0; i < 3; ++i) {
        const std::uint32_t twin =
            topology_.twin(topology_.leavingIn(star.triangle[i], star.ring[i]));
        if (twin == PatchTopology::kNone) return false;
        opposite[i] = twin / 3;
    }
    if (opposite[1] != opposite[0] || opposite[2] != opposite[0]) return false;
    const Vec3 origin = patch_.points[star.ring[0]];
    const auto volume6 = [&](std::uint32_t t) {
        const auto& [a, b, c] = patch_.triangles[t];
        return dot(patch_.points[a] - origin,
                   cross(patch_.points[b] - origin, patch_.points[c] - origin));
    };
    double before = volume6(opposite[0]);
    for (int i = 0; i < star.count; ++i) before += volume6(star.triangle[i]);
    for (int i = 0; i < star.removedCount; ++i) before += volume6(star.removed[i]);
    const double after =
        dot(change.star.vertex - origin,
            cross(patch_.points[star.ring[1]] - origin, patch_.points[star.ring[2]] - origin));
    return (before > 0) != (after > 0);
}

/// \pre shapeOrDistance() refused nothing
bool PatchSimplifier::crossesNothing(const Change& change) {
    return !guard_.needsProof(change.star, change.samples.isCrowded) ||
           guard_.crossesNothing(change.star);
}

bool PatchSimplifier::isInBox(const Vec3& p) const {
    if (limits_.box && !limits_.box->contains(p)) return false;
    const Vec3 index = frame_.toIndex(p);
    for (int a = 0; a < 3; ++a) {
        if (!(index[a] >= patch_.lowIndex[a] && index[a] <= patch_.highIndex[a])) return false;
    }
    return true;
}

void PatchSimplifier::fitVertices() {
    for (std::uint32_t v = 0; v < patch_.points.size(); ++v) {
        if (!mayChange(v) || patch_.states[v] == Patch::State::Fitted) continue;
        // one with too many triangles is not fitted, and stays as it is
        const bool isBetter = evaluateFit(v);
        patch_.states[v] = Patch::State::Fitted;
        if (isBetter) apply(change_);
    }
}

/// \param star  a vertex's, shaped for its present place \param own  the vertex's quadric
Vec3 PatchSimplifier::fittedPlace(const ChangedStar& star, const Quadric& own) const {
    // a sample's distance is linear in the vertex's step d: n . (s - q) - w n . d, w the weight of
    // the vertex at the sample's foot q; a sample counts as a voxel's face of surface
    const double scale = kQuadricWeight / (frame_.voxelMm() * frame_.voxelMm());
    Quadric sum;
    sum.xx = scale * own.xx, sum.xy = scale * own.xy, sum.xz = scale * own.xz;
    sum.yy = scale * own.yy, sum.yz = scale * own.yz, sum.zz = scale * own.zz;
    sum.b = scale * (own.timesA(star.vertex) + own.b);
    for (int i = 0; i < star.star.count; ++i) {
        const ChangedStar::Wedge& w = star.wedge[i];
        const Vec3 normal = (1 / w.length) * w.area2;
        for (std::uint32_t s = errors_.first(star.star.triangle[i]); s != ErrorTracker::kNone;
             s = errors_.next(s)) {
            const Vec3 d = patch_.samples[s].point() - star.vertex;
            const double d1 = dot(d, w.e1), d2 = dot(d, w.e2);
            const double u = std::clamp((w.a22 * d1 - w.a12 * d2) * w.inverse, 0.0, 1.0),
                         t = std::clamp((w.a11 * d2 - w.a12 * d1) * w.inverse, 0.0, 1.0);
            const Vec3 g = std::max(0.0, 1 - u - t) * normal;
            sum.xx += g.x * g.x, sum.xy += g.x * g.y, sum.xz += g.x * g.z;
            sum.yy += g.y * g.y, sum.yz += g.y * g.z, sum.zz += g.z * g.z;
            sum.b += -dot(normal, d) * g;
        }
    }
    const Vec3 step = minimize(sum, {}, kFitStiffness).point;
    const double length = norm(step), most = kFitStep * frame_.voxelMm();
    return star.vertex + (length > most ? most / length : 1.0) * step;
}

}  // namespace adaptiso::detail
