#include <gtest/gtest.h>
#include <itkSmoothingRecursiveGaussianImageFilter.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "adaptiso/Preprocessing/Preprocess.h"

namespace adaptiso {
namespace {

/// What ITK's filter makes of the same samples and spacing.
template <class T>
std::vector<T> byItk(const std::vector<T>& samples, const Index3& size, const Vec3& spacing,
                     double sigmaMm) {
    using Image = itk::Image<T, 3>;
    const auto image = Image::New();
    typename Image::SizeType extent;
    typename Image::SpacingType step;
    for (int axis = 0; axis < 3; ++axis) {
        extent[axis] = static_cast<itk::SizeValueType>(size[axis]);
        step[axis] = spacing[axis];
    }
    image->SetRegions(extent);
    image->SetSpacing(step);
    image->Allocate();
    std::copy(samples.begin(), samples.end(), image->GetBufferPointer());
    const auto filter = itk::SmoothingRecursiveGaussianImageFilter<Image, Image>::New();
    filter->SetInput(image);
    filter->SetSigma(sigmaMm);
    filter->Update();
    const T* const smoothed = filter->GetOutput()->GetBufferPointer();
    return {smoothed, smoothed + samples.size()};
}

template <class T>
void expectItksNumbers() {
    const Index3 size{23, 4, 31};
    const Vec3 spacing{0.7, 1.0, 1.3};
    ImageGeometry geometry;
    geometry.size = size;
    for (int axis = 0; axis < 3; ++axis) {
        geometry.indexToPhysical.column[axis] = {0, 0, 0};
        geometry.indexToPhysical.column[axis][axis] = spacing[axis];
    }
    std::vector<T> samples(static_cast<std::size_t>(geometry.voxelCount()));
    std::mt19937 random(1);
    for (T& sample : samples) sample = static_cast<T>(random() % 4096) - 1000;
    for (const double sigmaMm : {0.4, 1.0, 1.5, 3.7}) {
        const Volume found = smoothVolumeRecursively(VolumeView(samples.data(), geometry), sigmaMm);
        const T* const ours = static_cast<const T*>(found.view().samples());
        const std::vector<T> theirs = byItk(samples, size, spacing, sigmaMm);
        EXPECT_TRUE(std::equal(theirs.begin(), theirs.end(), ours)) << "sigma " << sigmaMm;
    }
}

TEST(SmoothRecursively, GivesTheNumbersOfItksFilterToTheBit) {
    expectItksNumbers<float>();
    expectItksNumbers<double>();
}

}  // namespace
}  // namespace adaptiso
