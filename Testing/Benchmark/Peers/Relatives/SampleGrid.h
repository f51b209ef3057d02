#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "adaptiso/Core/Volume.h"

namespace adaptiso::benchmarks {

/// A volume's samples as float, for the methods of this folder. Positions are continuous indices.
class SampleGrid {
public:
    explicit SampleGrid(const VolumeView& volume) : geometry_(volume.geometry()) {
        samples_.resize(static_cast<std::size_t>(geometry_.voxelCount()));
        dispatchPixelType(volume, [&](const auto& view) {
            for (std::size_t n = 0; n < samples_.size(); ++n) {
                samples_[n] = static_cast<float>(view.samples[n]);
            }
        });
    }

    const ImageGeometry& geometry() const { return geometry_; }
    const Index3& size() const { return geometry_.size; }
    Index3 cells() const { return {size()[0] - 1, size()[1] - 1, size()[2] - 1}; }
    std::int64_t number(std::int64_t i, std::int64_t j, std::int64_t k) const {
        return i + size()[0] * (j + size()[1] * k);
    }
    float at(std::int64_t i, std::int64_t j, std::int64_t k) const {
        return samples_[static_cast<std::size_t>(number(i, j, k))];
    }
    const std::vector<float>& samples() const { return samples_; }
    /// The sample there, or the nearest one of the volume.
    float clamped(std::int64_t i, std::int64_t j, std::int64_t k) const {
        return at(std::clamp<std::int64_t>(i, 0, size()[0] - 1),
                  std::clamp<std::int64_t>(j, 0, size()[1] - 1),
                  std::clamp<std::int64_t>(k, 0, size()[2] - 1));
    }
    /// Trilinear. \pre p lies in the volume
    double linear(const Vec3& p) const {
        Index3 low;
        double part[3];
        for (int axis = 0; axis < 3; ++axis) {
            const auto n = static_cast<std::size_t>(axis);
            low[n] = std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(p[axis])), 0,
                                              std::max<std::int64_t>(size()[n] - 2, 0));
            part[axis] = p[axis] - static_cast<double>(low[n]);
        }
        double sum = 0;
        for (int corner = 0; corner < 8; ++corner) {
            double weight = 1;
            for (int axis = 0; axis < 3; ++axis) {
                weight *= corner >> axis & 1 ? part[axis] : 1 - part[axis];
            }
            if (weight == 0) continue;
            sum += weight * at(low[0] + (corner & 1), low[1] + (corner >> 1 & 1),
                               low[2] + (corner >> 2 & 1));
        }
        return sum;
    }
    /// A cell has samples on each side of the isovalue.
    bool isActive(std::int64_t i, std::int64_t j, std::int64_t k, double isovalue) const {
        int inside = 0;
        for (int corner = 0; corner < 8; ++corner) {
            inside +=
                at(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2 & 1)) >= isovalue;
        }
        return inside > 0 && inside < 8;
    }
    Vec3 gradient(std::int64_t i, std::int64_t j, std::int64_t k) const {
        return {double{clamped(i + 1, j, k)} - clamped(i - 1, j, k),
                double{clamped(i, j + 1, k)} - clamped(i, j - 1, k),
                double{clamped(i, j, k + 1)} - clamped(i, j, k - 1)};
    }

private:
    ImageGeometry geometry_;
    std::vector<float> samples_;
};

}  // namespace adaptiso::benchmarks
