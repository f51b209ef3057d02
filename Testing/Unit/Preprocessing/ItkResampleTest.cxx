#include <gtest/gtest.h>
#include <itkBSplineInterpolateImageFunction.h>
#include <itkLinearInterpolateImageFunction.h>
#include <itkNearestNeighborInterpolateImageFunction.h>
#include <itkResampleImageFilter.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "Grids.h"
#include "adaptiso/Preprocessing/Preprocess.h"

namespace adaptiso::testing {
namespace {

using Filter = itk::ResampleImageFilter<itk::Image<double, 3>, itk::Image<double, 3>>;

void setGeometry(const ImageGeometry& geometry, const auto& set) {
    Filter::OriginPointType origin;
    Filter::SpacingType spacing;
    Filter::DirectionType direction;
    Filter::SizeType size;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3& step = geometry.indexToPhysical.column[axis];
        size[axis] = static_cast<itk::SizeValueType>(geometry.size[axis]);
        origin[axis] = geometry.originMm[axis];
        spacing[axis] = norm(step);
        for (int row = 0; row < 3; ++row) direction(row, axis) = step[row] / norm(step);
    }
    set(size, origin, spacing, direction);
}

/// What ITK's filter makes of the samples on `grid`.
std::vector<double> byItk(const std::vector<double>& samples, const ImageGeometry& geometry,
                          const ImageGeometry& grid, Interpolation interpolation) {
    using Image = itk::Image<double, 3>;
    const auto image = Image::New();
    setGeometry(geometry, [&](const auto& size, const auto& origin, const auto& spacing,
                              const auto& direction) {
        image->SetRegions(size);
        image->SetOrigin(origin);
        image->SetSpacing(spacing);
        image->SetDirection(direction);
    });
    image->Allocate();
    std::copy(samples.begin(), samples.end(), image->GetBufferPointer());
    const auto filter = Filter::New();
    filter->SetInput(image);
    filter->SetDefaultPixelValue(*std::min_element(samples.begin(), samples.end()));
    if (interpolation == Interpolation::Linear) {
        filter->SetInterpolator(itk::LinearInterpolateImageFunction<Image, double>::New());
    } else if (interpolation == Interpolation::Nearest) {
        filter->SetInterpolator(itk::NearestNeighborInterpolateImageFunction<Image, double>::New());
    } else {
        const auto spline = itk::BSplineInterpolateImageFunction<Image, double, double>::New();
        spline->SetSplineOrder(3);
        filter->SetInterpolator(spline);
    }
    setGeometry(grid, [&](const auto& size, const auto& origin, const auto& spacing,
                          const auto& direction) {
        filter->SetSize(size);
        filter->SetOutputOrigin(origin);
        filter->SetOutputSpacing(spacing);
        filter->SetOutputDirection(direction);
    });
    filter->Update();
    const double* const result = filter->GetOutput()->GetBufferPointer();
    return {result, result + grid.voxelCount()};
}

// Along the axes of space to the bit. Elsewhere ITK's inverse of the directions has other last
// bits, which put a place that is on the border of a sheared image to its other side.
TEST(Resample, GivesTheNumbersOfItksFilter) {
    std::mt19937 random(1);
    for (const Index3& size : {Index3{23, 5, 31}, Index3{3, 19, 17}}) {  // longer, shorter than 18
        for (const auto& [name, geometry] : kindsOfGrid(size, {0.7, 1.1, 2.9})) {
            std::vector<double> samples(static_cast<std::size_t>(geometry.voxelCount()));
            for (double& sample : samples) sample = static_cast<double>(random() % 4096) - 1000;
            const double farthest = name == "centred" ? 0 : 1e-9;
            for (const double stepMm : {0.31, 1.0}) {
                for (const auto interpolation :
                     {Interpolation::Nearest, Interpolation::Linear, Interpolation::BSpline}) {
                    const Volume found =
                        resampleVolume(VolumeView(samples.data(), geometry), stepMm, interpolation);
                    const double* const ours = found.view().as<double>().samples;
                    const std::vector<double> theirs =
                        byItk(samples, geometry, found.view().geometry(), interpolation);
                    std::size_t apart = 0;
                    for (std::size_t n = 0; n < theirs.size(); ++n) {
                        if (!(std::abs(ours[n] - theirs[n]) <= farthest)) ++apart;
                    }
                    EXPECT_LE(apart, name == "sheared" ? theirs.size() / 500 : 0)
                        << name << ' ' << stepMm << " mm " << toString(interpolation);
                }
            }
        }
    }
}

}  // namespace
}  // namespace adaptiso::testing
