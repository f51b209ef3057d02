#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <random>
#include <utility>

#include "Support/Meshes.h"
#include "Surfaces.h"
#include "adaptive/collapse/CollapseQueue.h"

namespace adaptiso::testing {
namespace {

using detail::CollapseQueue;
using detail::Patch;
using detail::PatchTopology;
using detail::Star;

/// A queue beside a list of all edges; costs by chance, many of them equal.
class QueueAndList {
public:
    QueueAndList(Patch patch, unsigned seed)
        : patch_(std::move(patch)), topology_(patch_), queue_(topology_, patch_), random_(seed) {
        queue_.fill(patch_, costOf());
    }

    /// Takes edges until none is left: each is the first of the list. A third of them is refused.
    void run() {
        for (;;) {
            const CollapseQueue::Edge edge = queue_.cheapest();
            expectFirst(edge);
            if (edge.halfEdge == CollapseQueue::kNone || ::testing::Test::HasFailure()) break;
            step(edge.halfEdge);
        }
        EXPECT_GT(collapses_, 5);
        EXPECT_GT(refusals_, 5);
        queue_.forEachLeft([](std::uint32_t) { ADD_FAILURE() << "an edge is left"; });
    }

private:
    using Ends = std::pair<std::uint32_t, std::uint32_t>;

    Ends endsOf(std::uint32_t h) const { return std::minmax({topology_.from(h), topology_.to(h)}); }

    std::function<double(std::uint32_t)> costOf() {
        return [this](std::uint32_t h) {
            costs_.erase(endsOf(h));
            const bool mayGo = topology_.isMovable(topology_.from(h)) &&
                               topology_.isMovable(topology_.to(h)) && random_() % 5 > 0;
            if (!mayGo) return CollapseQueue::kNever;
            const auto cost = static_cast<double>(random_() % 12);
            costs_[endsOf(h)] = cost;
            return cost;
        };
    }

    void expectFirst(const CollapseQueue::Edge& edge) const {
        double least = CollapseQueue::kNever;
        std::uint32_t first = CollapseQueue::kNone;
        for (std::uint32_t h = 0; h < 3 * patch_.ownTriangles; ++h) {
            if (patch_.triangles[h / 3][0] == Patch::kGone) continue;
            const auto known = costs_.find(endsOf(h));
            if (known == costs_.end() || known->second >= least) continue;
            least = known->second;
            first = h;
        }
        EXPECT_EQ(edge.cost, least);
        EXPECT_EQ(edge.halfEdge, first);
    }

    void step(std::uint32_t h) {
        Star star;
        if (random_() % 3 == 0 || !topology_.starOfEdge(h, star)) {
            queue_.refuse(h);
            costs_.erase(endsOf(h));
            ++refusals_;
            return;
        }
        const std::uint32_t kept = topology_.from(h), gone = topology_.to(h);
        topology_.collapse(h, star);
        std::erase_if(costs_, [&](const auto& cost) {
            return cost.first.first == gone || cost.first.second == gone;
        });
        queue_.update(kept, star, costOf());
        ++collapses_;
    }

    Patch patch_;
    PatchTopology topology_;
    CollapseQueue queue_;
    std::mt19937 random_;
    std::map<Ends, double> costs_;  ///< of the edges that are in
    int collapses_ = 0, refusals_ = 0;
};

}  // namespace

TEST(CollapseQueue, GivesTheFirstOfAllEdgesWhateverWasCollapsedOrRefused) {
    for (unsigned seed = 0; seed < 10; ++seed) {
        QueueAndList(patchOf(icosphere(2)), seed).run();
        QueueAndList(patchOf(icosphere(2), 20), seed).run();  // with vertices that stay
        QueueAndList(patchOf(planeMesh(9, 7)), seed).run();
    }
}

TEST(CollapseQueue, KnowsEdgesOnOpenBorders) {
    for (unsigned seed = 0; seed < 10; ++seed) {
        Patch patch = patchOf(planeMesh(6, 6));
        patch.marks.assign(patch.points.size(), Patch::kPlain);
        for (std::uint32_t v = 0; v < patch.points.size(); ++v) {
            const Vec3& p = patch.points[v];
            if (p.x == 0 || p.x == 6 || p.y == 0 || p.y == 6) patch.marks[v] = Patch::kBorder;
        }
        QueueAndList(std::move(patch), seed).run();
    }
}

}  // namespace adaptiso::testing
