#include <itkImage.h>
#include <itkSmoothingRecursiveGaussianImageFilter.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "ImageSteps.h"

namespace adaptiso::headmodel {

std::vector<float> smoothed(std::vector<float> values, const ImageGeometry& grid, double sigmaMm) {
    if (sigmaMm < stepMm(grid) / 3) return values;
    using Image = itk::Image<float, 3>;
    // cubic voxels along x, y, z: all that a filter in mm needs to know
    auto image = Image::New();
    Image::RegionType region;
    for (int axis = 0; axis < 3; ++axis) region.SetSize(axis, grid.size[axis]);
    image->SetRegions(region);
    Image::SpacingType spacing;
    spacing.Fill(stepMm(grid));
    image->SetSpacing(spacing);
    image->GetPixelContainer()->SetImportPointer(values.data(), values.size(), false);

    auto filter = itk::SmoothingRecursiveGaussianImageFilter<Image, Image>::New();
    filter->SetInput(image);
    filter->SetSigma(sigmaMm);
    // ITK takes as many threads as the rest of the program
    filter->SetNumberOfWorkUnits(static_cast<itk::ThreadIdType>(
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)));
    filter->Update();
    const float* const first = filter->GetOutput()->GetBufferPointer();
    std::copy(first, first + values.size(), values.begin());
    return values;
}

}  // namespace adaptiso::headmodel
