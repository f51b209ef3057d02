#include <gtest/gtest.h>
#include <itkImage.h>
#include <itkSmoothingRecursiveGaussianImageFilter.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "HeadPhantoms.h"
#include "ImageSteps.h"

namespace adaptiso::headmodel {
namespace {

using namespace adaptiso::testing;

TEST(Smoothed, IsWhatItksRecursiveFilterMakes) {
    const ImageGeometry grid = centredGeometry({19, 26, 13}, {0.9, 0.9, 0.9});
    std::vector<float> values = partInside(sphere({0.3, -0.2, 0.1}, 5), grid);
    std::uint64_t seed = 3;
    for (std::size_t n = 0; n < values.size() / 2; ++n) {
        values[n] += static_cast<float>(nextRandom(seed) % 1000) / 1000;
    }
    using Image = itk::Image<float, 3>;
    auto image = Image::New();
    image->SetRegions(Image::SizeType{19, 26, 13});
    const double spacing[]{0.9, 0.9, 0.9};
    image->SetSpacing(spacing);
    image->Allocate();
    std::copy(values.begin(), values.end(), image->GetBufferPointer());
    for (const double sigma : {0.5, 1.5, 6.0}) {
        auto filter = itk::SmoothingRecursiveGaussianImageFilter<Image, Image>::New();
        filter->SetInput(image);
        filter->SetSigma(sigma);
        filter->Update();
        const float* const first = filter->GetOutput()->GetBufferPointer();
        const std::vector<float> expected(first, first + values.size());
        EXPECT_EQ(smoothed(values, grid, sigma), expected) << sigma;
    }
}

}  // namespace
}  // namespace adaptiso::headmodel
