#include "lattice/LatticeSampler.h"

#include <algorithm>
#include <cmath>

#include "adaptiso/Core/Volume.h"

namespace adaptiso::detail {
namespace {

/// \tparam isWindow  of the volume only a part is there, from the sample `first` on
template <class T, bool isWindow>
class TypedSampler final : public LatticeSampler {
public:
    /// \param volume  the samples that are there, with the geometry of the whole
    TypedSampler(const TypedVolumeView<T>& volume, const Index3& first, const Index3& thereSize,
                 double isovalue, Border border)
        : volume_(volume),
          first_(first),
          thereSize_(thereSize),
          inside_(isovalue),
          isovalue_(isovalue),
          closed_(border == Border::Closed),
          gradientToPhysical_(volume.geometry.gradientToPhysical()) {}

    void insideRows(const Index3& first, int count, std::uint32_t* rows) const override {
        const Index3& size = volume_.geometry.size;
        const bool whole = first[0] >= 0 && first[0] + count <= size[0];
        for (int z = 0; z < count; ++z) {
            for (int y = 0; y < count; ++y) {
                std::int64_t j = first[1] + y, k = first[2] + z;
                std::uint32_t& row = rows[z * count + y];
                row = 0;
                if (closed_ && (j < 0 || j >= size[1] || k < 0 || k >= size[2])) continue;
                j = std::clamp<std::int64_t>(j, 0, size[1] - 1);
                k = std::clamp<std::int64_t>(k, 0, size[2] - 1);
                row = whole ? wholeRow(&sampleAt(first[0], j, k), count)
                            : clippedRow(first[0], j, k, count);
            }
        }
    }

    bool insideJoins(const Index3& corner, int normal) const override {
        const int u = (normal + 1) % 3, v = (normal + 2) % 3;
        double value[2][2];
        for (int b = 0; b < 2; ++b) {
            for (int a = 0; a < 2; ++a) {
                Index3 p = corner;
                p[u] += a;
                p[v] += b;
                if (closed_ && !contains(p)) return false;
                value[b][a] = static_cast<double>(clamped(p)) - isovalue_;
            }
        }
        const double main = value[0][0] * value[1][1], other = value[0][1] * value[1][0];
        return inside_(clamped(corner)) ? main >= other : other >= main;
    }

    double crossingAlong(const LatticeEdge& edge) const override {
        if (isVirtual(edge)) return 0.5;
        const double below = static_cast<double>(clamped(edge.sample)),
                     above = static_cast<double>(clamped(highEnd(edge)));
        const double t = (isovalue_ - below) / (above - below);
        return std::isnan(t) ? 0.5 : std::clamp(t, kHair, 1 - kHair);  // NaN at an end
    }

    Crossing crossing(const LatticeEdge& edge) const override {
        return crossingAt(edge, crossingAlong(edge));
    }

    Crossing midpoint(const LatticeEdge& edge) const override { return crossingAt(edge, 0.5); }

    Vec3 normalAt(const Vec3& index) const override {
        Index3 low;
        Vec3 part;
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = static_cast<std::int64_t>(std::floor(index[axis]));
            part[axis] = index[axis] - static_cast<double>(low[axis]);
        }
        Vec3 gradient;
        for (int corner = 0; corner < 8; ++corner) {
            Index3 p = low;
            double weight = 1;
            for (int axis = 0; axis < 3; ++axis) {
                const int high = corner >> axis & 1;
                p[axis] += high;
                weight *= high == 1 ? part[axis] : 1 - part[axis];
            }
            if (closed_ && !contains(p)) return {};
            gradient += weight * gradientAt(p);
        }
        return outward(gradient);
    }

private:
    static Index3 highEnd(const LatticeEdge& edge) {
        Index3 q = edge.sample;
        ++q[edge.axis];
        return q;
    }

    /// One end lies beyond a closed border.
    bool isVirtual(const LatticeEdge& edge) const {
        return closed_ && (!contains(edge.sample) || !contains(highEnd(edge)));
    }

    /// At part `t` of the edge.
    Crossing crossingAt(const LatticeEdge& edge, double t) const {
        const Index3& p = edge.sample;
        Vec3 index{static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
        index[edge.axis] += t;
        Vec3 gradient;
        if (isVirtual(edge)) {
            gradient[edge.axis] = contains(p) ? -1 : 1;
        } else {
            gradient = (1 - t) * gradientAt(p) + t * gradientAt(highEnd(edge));
        }
        return {volume_.geometry.toPhysical(index), outward(gradient)};
    }

    /// The unit normal that belongs to a gradient per index step.
    Vec3 outward(const Vec3& gradient) const {
        const Vec3 normal = -normalized(gradientToPhysical_ * gradient);
        return std::isfinite(squaredNorm(normal)) ? normal : Vec3{};
    }

    /// \pre it is there
    const T& sampleAt(std::int64_t i, std::int64_t j, std::int64_t k) const {
        if constexpr (!isWindow) return volume_.at(i, j, k);
        return volume_.samples[i - first_[0] +
                               thereSize_[0] * (j - first_[1] + thereSize_[1] * (k - first_[2]))];
    }

    std::uint32_t wholeRow(const T* samples, int count) const {
        std::uint32_t row = 0;
        for (int x = 0; x < count; ++x) row |= static_cast<std::uint32_t>(inside_(samples[x])) << x;
        return row;
    }

    std::uint32_t clippedRow(std::int64_t i, std::int64_t j, std::int64_t k, int count) const {
        const std::int64_t width = volume_.geometry.size[0];
        std::uint32_t row = 0;
        for (int x = 0; x < count; ++x) {
            if (closed_ && (i + x < 0 || i + x >= width)) continue;
            const T value = sampleAt(std::clamp<std::int64_t>(i + x, 0, width - 1), j, k);
            row |= static_cast<std::uint32_t>(inside_(value)) << x;
        }
        return row;
    }

    bool isVirtual(const Index3& p, const Index3& q) const {
        return closed_ && (!contains(p) || !contains(q));
    }

    bool contains(const Index3& p) const {
        const Index3& size = volume_.geometry.size;
        return p[0] >= 0 && p[0] < size[0] && p[1] >= 0 && p[1] < size[1] && p[2] >= 0 &&
               p[2] < size[2];
    }

    T clamped(const Index3& p) const {
        const Index3& size = volume_.geometry.size;
        return sampleAt(std::clamp<std::int64_t>(p[0], 0, size[0] - 1),
                        std::clamp<std::int64_t>(p[1], 0, size[1] - 1),
                        std::clamp<std::int64_t>(p[2], 0, size[2] - 1));
    }

    /// Central difference per index step; one-sided on the volume's border.
    Vec3 gradientAt(const Index3& p) const {
        Vec3 gradient;
        for (int axis = 0; axis < 3; ++axis) {
            const std::int64_t last = volume_.geometry.size[axis] - 1;
            Index3 before = p, after = p;
            before[axis] = std::clamp<std::int64_t>(p[axis] - 1, 0, last);
            after[axis] = std::clamp<std::int64_t>(p[axis] + 1, 0, last);
            if (after[axis] == before[axis]) continue;
            gradient[axis] =
                (static_cast<double>(clamped(after)) - static_cast<double>(clamped(before))) /
                static_cast<double>(after[axis] - before[axis]);
        }
        return gradient;
    }

    TypedVolumeView<T> volume_;
    Index3 first_, thereSize_;  ///< of a window
    IsovalueTest<T> inside_;
    double isovalue_;
    bool closed_;
    Mat3 gradientToPhysical_;
};

}  // namespace

std::unique_ptr<LatticeSampler> LatticeSampler::make(const VolumeView& volume, double isovalue,
                                                     Border border) {
    return dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
        return std::unique_ptr<LatticeSampler>(
            std::make_unique<TypedSampler<T, false>>(view, Index3{}, Index3{}, isovalue, border));
    });
}

std::unique_ptr<LatticeSampler> LatticeSampler::makeOfWindow(const VolumeView& window,
                                                             const Index3& first,
                                                             const ImageGeometry& whole,
                                                             double isovalue) {
    return dispatchPixelType(window, [&]<class T>(const TypedVolumeView<T>& view) {
        const TypedVolumeView<T> volume{view.samples, whole};
        return std::unique_ptr<LatticeSampler>(std::make_unique<TypedSampler<T, true>>(
            volume, first, view.geometry.size, isovalue, Border::Closed));
    });
}

}  // namespace adaptiso::detail
