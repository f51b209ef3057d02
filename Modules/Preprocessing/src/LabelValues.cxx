#include "adaptiso/Preprocessing/LabelValues.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <type_traits>
#include <utility>

namespace adaptiso {
namespace {

constexpr std::size_t kFewest = 3, kMost = 1000;
constexpr double kShortestRun = 2, kLeastStep = 0.125;
constexpr double kCoarse = 5;
/// Runs that are enough to tell a scan.
constexpr double kEnoughRuns = 20000;

struct Tally {
    double voxels = 0, runs = 0;
};

template <class T>
class Census {
public:
    explicit Census(const TypedVolumeView<T>& view) : view_(view) {}

    std::optional<LabelValues> find() {
        const Index3& size = view_.geometry.size;
        const std::int64_t layer = size[0] * size[1];
        for (std::int64_t k = 0; k < size[2]; ++k) {
            if (!addLayer(k * layer, layer) || (runs() > kEnoughRuns && meanRun() < kShortestRun)) {
                return std::nullopt;
            }
        }
        if (tallies_.size() < kFewest || meanRun() < kShortestRun) return std::nullopt;
        if (commonDivisor() >= kCoarse) return std::nullopt;
        if (meanStep() < kLeastStep * static_cast<double>(tallies_.size())) return std::nullopt;
        return LabelValues{tallies_.size(),
                           static_cast<double>(std::next(tallies_.begin())->first)};
    }

private:
    static bool isWhole(T value) {
        if constexpr (std::is_floating_point_v<T>) {
            return std::isfinite(value) && value == std::floor(value);
        }
        return true;
    }

    /// \return  there are not too many values, all whole
    bool addLayer(std::int64_t begin, std::int64_t count) {
        const std::int64_t row = view_.geometry.size[0];
        Tally* tally = nullptr;
        for (std::int64_t n = begin; n < begin + count; ++n) {
            const T value = view_.samples[n];
            const bool isFirst = (n - begin) % row == 0;
            if (isFirst || value != view_.samples[n - 1]) {
                if (!isWhole(value)) return false;
                tally = &tallies_[value];
                if (tallies_.size() > kMost) return false;
                ++tally->runs;
                if (!isFirst) ++steps_[std::minmax(value, T(view_.samples[n - 1]))];
            }
            ++tally->voxels;
        }
        return true;
    }

    Tally commonest() const {
        return std::max_element(
                   tallies_.begin(), tallies_.end(),
                   [](const auto& a, const auto& b) { return a.second.voxels < b.second.voxels; })
            ->second;
    }
    double runs() const {
        double sum = -commonest().runs;
        for (const auto& entry : tallies_) sum += entry.second.runs;
        return sum;
    }
    /// Voxels in a row along i that hold the same value, but for the commonest.
    double meanRun() const {
        double voxels = -commonest().voxels;
        for (const auto& entry : tallies_) voxels += entry.second.voxels;
        return voxels / std::max(runs(), 1.0);
    }
    double commonDivisor() const {
        double divisor = 0;
        for (const auto& entry : tallies_) {
            for (double value = std::abs(static_cast<double>(entry.first)); value > 0;) {
                divisor = std::exchange(value, std::fmod(divisor, value));
            }
        }
        return divisor;
    }
    /// How far apart in their order the values are where they change.
    double meanStep() const {
        std::map<T, double> rank;
        for (const auto& entry : tallies_) {
            rank.emplace_hint(rank.end(), entry.first, static_cast<double>(rank.size()));
        }
        double sum = 0, count = 0;
        for (const auto& [values, times] : steps_) {
            sum += times * (rank.at(values.second) - rank.at(values.first));
            count += times;
        }
        // along i alone: slabs that lie across other axes change nowhere
        return count > 0 ? sum / count : static_cast<double>(tallies_.size());
    }

    const TypedVolumeView<T>& view_;
    std::map<T, Tally> tallies_;
    std::map<std::pair<T, T>, double> steps_;  ///< between neighbours, the smaller first
};

}  // namespace

std::optional<LabelValues> findLabelValues(const VolumeView& volume) {
    return dispatchPixelType(
        volume, []<class T>(const TypedVolumeView<T>& view) { return Census<T>(view).find(); });
}

}  // namespace adaptiso
