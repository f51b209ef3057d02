#pragma once

#include <array>
#include <vector>

#include "ImageSteps.h"

namespace adaptiso::headmodel {

/// Brightness by a coil's sensitivity: tissue of one kind is brighter here than there.
/// The logarithm is a quadratic of place, kept within what the tissue looked at has.
class BiasField {
public:
    static constexpr int kTerms = 9;  ///< x y z xx yy zz xy xz yz

    BiasField() = default;

    /// The field without which tissue falls into the narrowest classes: the entropy of the
    /// logarithms of means of blocks of 4 mm is least [Likar2001]. Quadratics can't follow the
    /// difference between white and grey matter, and the entropy of both is low, so that no class
    /// need be known.
    /// \param tissue  where `values` are looked at; too little of it (1000 blocks) gives no field
    /// \param airLevel  of `values`, where the field multiplies nothing
    /// \pre values > airLevel in tissue
    /// Cost: some 300 histograms of the blocks; the same for any number of threads.
    static BiasField estimated(const std::vector<float>& values, double airLevel,
                               const Mask& tissue, const ImageGeometry& grid);

    /// Takes it out of `values` on the grid it was estimated on.
    void removeFrom(std::vector<float>& values, double airLevel, const Index3& size) const;

    /// The least and the largest factor within the tissue looked at, its median being 1.
    double least() const;
    double most() const;

private:
    double logarithmAt(const Vec3& index) const;

    Vec3 middle_;          ///< in voxels
    double perVoxel_ = 0;  ///< places are from -1 to 1 along the longest side
    std::array<double, kTerms> coefficients_{};
    double offset_ = 0, leastLog_ = 0, mostLog_ = 0;
};

}  // namespace adaptiso::headmodel
