#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "SixEquations.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/PortableMath.h"
#include "adaptiso/HeadModel/Landmarks.h"

namespace adaptiso {
namespace {

/// About an axis through `pivot`, by the vector's length (radians).
AffineTransform rotation(const Vec3& vector, const Vec3& pivot) {
    const double angle = norm(vector), s = portable::sin(angle), c = portable::cos(angle);
    const Vec3 axis = normalized(vector);
    AffineTransform turn;
    for (int a = 0; a < 3; ++a) {
        Vec3 unit;
        unit[a] = 1;
        turn.linear.column[a] = c * unit + s * cross(axis, unit) + (1 - c) * dot(axis, unit) * axis;
    }
    turn.offset = pivot - turn.linear * pivot;
    return turn;
}

class Fit {
public:
    Fit(const std::vector<Vec3>& points, const TriangleMesh& skin, const Landmarks& own,
        const Landmarks& head)
        : points_(points),
          tree_(skin),
          kept_(points.size() - points.size() / 10),
          landmarks_{{{own.nasionMm, head.nasionMm, weightOf(head.nasionUncertaintyMm)},
                      {own.leftEarMm, head.leftEarMm, weightOf(head.earUncertaintyMm)},
                      {own.rightEarMm, head.rightEarMm, weightOf(head.earUncertaintyMm)}}} {}

    /// Moves that make the points' distances least, from `move` on.
    AffineTransform refined(AffineTransform move) const {
        constexpr int kRounds = 100;
        constexpr double kStillMm = 1e-4;
        for (int round = 0; round < kRounds; ++round) {
            const AffineTransform step = stepFrom(move);
            const Vec3 middle = move(points_.front());
            move = step * move;
            if (norm(move(points_.front()) - middle) < kStillMm) break;
        }
        return move;
    }

    /// Distances of all points, the smallest first.
    std::vector<double> distancesMm(const AffineTransform& move) const {
        std::vector<double> mm;
        for (const Vec3& p : points_) {
            mm.push_back(std::sqrt(tree_.closestPoint(move(p)).squaredDistanceMm2));
        }
        std::sort(mm.begin(), mm.end());
        return mm;
    }

    double meanOfKept(const std::vector<double>& sortedMm) const {
        double sum = 0;
        for (std::size_t n = 0; n < kept_; ++n) sum += sortedMm[n];
        return sum / static_cast<double>(kept_);
    }

private:
    /// One step of Gauss and Newton: each point goes along the line to its nearest place.
    AffineTransform stepFrom(const AffineTransform& move) const {
        struct Pull {
            Vec3 at, along;
            double mm;
        };
        std::vector<Pull> pulls;
        Vec3 middle;
        for (const Vec3& p : points_) {
            const Vec3 at = move(p);
            const Vec3 along = at - tree_.closestPoint(at).pointMm;
            pulls.push_back({at, normalized(along), norm(along)});
            middle += (1 / static_cast<double>(points_.size())) * at;
        }
        std::stable_sort(pulls.begin(), pulls.end(),
                         [](const Pull& a, const Pull& b) { return a.mm < b.mm; });
        pulls.resize(kept_);
        SixEquations e{};
        const auto add = [&](const Vec3& at, const Vec3& along, double mm, double weight) {
            const Vec3 turn = cross(at - middle, along);
            const std::array<double, 6> row{turn.x, turn.y, turn.z, along.x, along.y, along.z};
            for (std::size_t a = 0; a < 6; ++a) {
                for (std::size_t b = 0; b < 6; ++b) e[a][b] += weight * row[a] * row[b];
                e[a][6] -= weight * row[a] * mm;
            }
        };
        for (const Pull& pull : pulls) add(pull.at, pull.along, pull.mm, 1);
        for (const auto& [from, to, weight] : landmarks_) {
            const Vec3 at = move(from);
            for (int axis = 0; axis < 3; ++axis) {
                Vec3 along;
                along[axis] = 1;
                add(at, along, at[axis] - to[axis], weight);
            }
        }
        // the landmarks leave no move open
        const std::array<double, 6> x = solved(e, 0).value();
        AffineTransform step = rotation({x[0], x[1], x[2]}, middle);
        step.offset += Vec3{x[3], x[4], x[5]};
        return step;
    }

    /// Beside a head point's.
    static double weightOf(double uncertaintyMm) {
        constexpr double kPointMm = 2, kLeastMm = 5;
        const double share = kPointMm / std::max(uncertaintyMm, kLeastMm);
        return share * share;
    }

    struct Pinned {
        Vec3 from, to;
        double weight;
    };

    const std::vector<Vec3>& points_;
    AabbTree tree_;
    std::size_t kept_;
    std::array<Pinned, 3> landmarks_;
};

}  // namespace

SkinFit fitToSkin(const std::vector<Vec3>& points, const TriangleMesh& skin, const Landmarks& own,
                  const Landmarks& head) {
    const AffineTransform start = byLandmarks(own, head);
    if (points.empty()) throw InvalidInput("fitToSkin: there is no point, must be one or more");
    const Fit fit(points, skin, own, head);
    Vec3 middle;
    for (const Vec3& p : points) middle += (1 / static_cast<double>(points.size())) * start(p);
    SkinFit best;
    double bestMm = 0;
    for (const double nodDeg : {0.0, 12.0, -12.0}) {  // guessed ears are off up and down
        const Vec3 nod{nodDeg * std::numbers::pi / 180, 0, 0};
        const AffineTransform move = fit.refined(rotation(nod, middle) * start);
        const std::vector<double> mm = fit.distancesMm(move);
        const double kept = fit.meanOfKept(mm);
        if (nodDeg != 0 && kept >= bestMm) continue;
        bestMm = kept;
        best = {move, 0, mm[(mm.size() * 95 - 1) / 100], mm.back()};
        for (const double one : mm) best.meanMm += one / static_cast<double>(mm.size());
    }
    return best;
}

}  // namespace adaptiso
