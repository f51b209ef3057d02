// Components by runs along x that touch, joined by a union of sets [Tarjan1975]: a mask has a few
// runs a row, so that this costs little more than to read it.
#include <algorithm>
#include <cstring>
#include <numeric>

#include "ImageSteps.h"

namespace adaptiso::headmodel {
namespace {

/// The runs of voxels equal to `value`, in the order of the volume, and which hang together.
/// Numbers of rows and runs fit into 32 bits: a working grid has 2^29 voxels at most.
class Runs {
public:
    struct Run {
        std::int32_t row;         ///< j + size[1] * k
        std::int32_t begin, end;  ///< along x
    };

    Runs(const Mask& mask, std::uint8_t value, const Index3& size) : size_(size) {
        find(mask, value);
        join();
    }

    std::int64_t count() const { return std::ssize(runs_); }
    const Run& run(std::int64_t n) const { return runs_[n]; }
    std::int64_t firstVoxel(std::int64_t n) const {
        return std::int64_t{runs_[n].row} * size_[0] + runs_[n].begin;
    }
    std::int64_t length(std::int64_t n) const { return runs_[n].end - runs_[n].begin; }
    /// The first run of the component that a run belongs to.
    std::int64_t component(std::int64_t n) const { return component_[n]; }

    /// The voxels of the runs for which isIn(component).
    template <class IsIn>
    Mask maskOf(const IsIn& isIn) const {
        Mask result(static_cast<std::size_t>(size_[0] * size_[1] * size_[2]), 0);
        for (std::int64_t n = 0; n < count(); ++n) {
            if (isIn(component_[n])) std::fill_n(result.begin() + firstVoxel(n), length(n), 1);
        }
        return result;
    }

private:
    void find(const Mask& mask, std::uint8_t value) {
        const auto other = static_cast<std::uint8_t>(value ^ 1);
        for (std::int64_t row = 0; row < size_[1] * size_[2]; ++row) {
            rowBegin_.push_back(count());
            const std::uint8_t* const first = mask.data() + row * size_[0];
            const auto next = [&](std::int64_t from, std::uint8_t what) {
                const void* const at = std::memchr(first + from, what, size_[0] - from);
                return at == nullptr ? size_[0] : static_cast<const std::uint8_t*>(at) - first;
            };
            for (std::int64_t i = next(0, value); i < size_[0];) {
                const std::int64_t end = next(i, other);
                runs_.push_back({static_cast<std::int32_t>(row), static_cast<std::int32_t>(i),
                                 static_cast<std::int32_t>(end)});
                i = end < size_[0] ? next(end, value) : end;
            }
        }
        rowBegin_.push_back(count());
    }

    void join() {
        component_.resize(runs_.size());
        std::iota(component_.begin(), component_.end(), 0);
        for (std::int64_t k = 0; k < size_[2]; ++k) {
            for (std::int64_t j = 0; j < size_[1]; ++j) {
                const std::int64_t row = j + size_[1] * k;
                if (j > 0) joinRows(row, row - 1);
                if (k > 0) joinRows(row, row - size_[1]);
            }
        }
        for (std::int64_t n = 0; n < count(); ++n) component_[n] = component_[component_[n]];
    }

    void joinRows(std::int64_t row, std::int64_t other) {
        std::int64_t a = rowBegin_[row], b = rowBegin_[other];
        while (a < rowBegin_[row + 1] && b < rowBegin_[other + 1]) {
            if (runs_[a].begin < runs_[b].end && runs_[b].begin < runs_[a].end) unite(a, b);
            ++(runs_[a].end < runs_[b].end ? a : b);
        }
    }

    std::int64_t root(std::int64_t n) {
        while (component_[n] != n) {
            component_[n] = component_[component_[n]];
            n = component_[n];
        }
        return n;
    }

    /// The first run is the root, so that roots come before what hangs on them.
    void unite(std::int64_t a, std::int64_t b) {
        a = root(a);
        b = root(b);
        component_[std::max(a, b)] = static_cast<std::int32_t>(std::min(a, b));
    }

    Index3 size_;
    std::vector<Run> runs_;
    std::vector<std::int64_t> rowBegin_;
    std::vector<std::int32_t> component_;
};

/// The component with the largest of sizes (by first run), of several the first.
Mask bestComponent(const Runs& runs, const std::vector<std::int64_t>& sizes) {
    const std::int64_t best = std::max_element(sizes.begin(), sizes.end()) - sizes.begin();
    return runs.maskOf([&](std::int64_t component) { return component == best; });
}

}  // namespace

Mask largestComponent(const Mask& mask, const Index3& size) {
    const Runs runs(mask, 1, size);
    std::vector<std::int64_t> voxels(runs.count(), 0);
    for (std::int64_t n = 0; n < runs.count(); ++n) voxels[runs.component(n)] += runs.length(n);
    return bestComponent(runs, voxels);
}

Mask widestComponent(const Mask& mask, const Index3& size) {
    const Runs runs(mask, 1, size);
    struct Box {
        Index3 low, high;
    };
    std::vector<Box> boxes(runs.count(), {size, {0, 0, 0}});
    for (std::int64_t n = 0; n < runs.count(); ++n) {
        const Runs::Run& run = runs.run(n);
        const Index3 low{run.begin, run.row % size[1], run.row / size[1]};
        const Index3 high{run.end, low[1] + 1, low[2] + 1};
        Box& box = boxes[runs.component(n)];
        for (int a = 0; a < 3; ++a) {
            box.low[a] = std::min(box.low[a], low[a]);
            box.high[a] = std::max(box.high[a], high[a]);
        }
    }
    std::vector<std::int64_t> volumes(runs.count(), 0);
    for (std::int64_t n = 0; n < runs.count(); ++n) {
        if (runs.component(n) != n) continue;
        volumes[n] = 1;
        for (int a = 0; a < 3; ++a) volumes[n] *= boxes[n].high[a] - boxes[n].low[a];
    }
    return bestComponent(runs, volumes);
}

Mask componentsWith(const Mask& seeds, const Mask& mask, const Index3& size) {
    const Runs runs(mask, 1, size);
    Mask hasSeed(runs.count(), 0);
    for (std::int64_t n = 0; n < runs.count(); ++n) {
        const std::uint8_t* const first = seeds.data() + runs.firstVoxel(n);
        if (std::any_of(first, first + runs.length(n), [](std::uint8_t v) { return v != 0; })) {
            hasSeed[runs.component(n)] = 1;
        }
    }
    return runs.maskOf([&](std::int64_t component) { return hasSeed[component] != 0; });
}

Mask filled(const Mask& mask, const Index3& size) {
    const Runs background(mask, 0, size);
    Mask reachesBorder(background.count(), 0);
    for (std::int64_t n = 0; n < background.count(); ++n) {
        const Runs::Run& run = background.run(n);
        const std::int64_t j = run.row % size[1], k = run.row / size[1];
        if (run.begin == 0 || run.end == size[0] || j == 0 || j + 1 == size[1] || k == 0 ||
            k + 1 == size[2]) {
            reachesBorder[background.component(n)] = 1;
        }
    }
    Mask result =
        background.maskOf([&](std::int64_t component) { return reachesBorder[component] != 0; });
    for (std::uint8_t& voxel : result) voxel ^= 1;
    return result;
}

}  // namespace adaptiso::headmodel
