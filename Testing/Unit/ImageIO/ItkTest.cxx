// Files that ITK itself writes.
#include <gtest/gtest.h>
#include <itkHistogram.h>
#include <itkImage.h>
#include <itkMetaImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkOtsuMultipleThresholdsCalculator.h>

#include <algorithm>

#include "Fixtures.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/ImageIO/SampleStatistics.h"

namespace adaptiso::testing {
namespace {

constexpr unsigned kSize[] = {4, 3, 2};

/// Oblique about z by the angle of the 3-4-5 triangle, anisotropic.
template <class T>
typename itk::Image<T, 3>::Pointer makeImage() {
    auto image = itk::Image<T, 3>::New();
    image->SetRegions(itk::Size<3>{{kSize[0], kSize[1], kSize[2]}});
    image->Allocate();
    const auto samples = countingSamples<T>(24);
    std::copy(samples.begin(), samples.end(), image->GetBufferPointer());
    const double spacing[] = {1, 2, 5}, origin[] = {10, 20, 30};
    image->SetSpacing(spacing);
    image->SetOrigin(origin);
    typename itk::Image<T, 3>::DirectionType direction;
    direction.SetIdentity();
    direction(0, 0) = direction(1, 1) = 0.8;
    direction(0, 1) = -0.6;
    direction(1, 0) = 0.6;
    image->SetDirection(direction);
    return image;
}

void expectObliqueGeometry(const ImageGeometry& g) {
    constexpr double kRounding = 1e-12;
    EXPECT_EQ(g.size, (Index3{4, 3, 2}));
    expectNear(g.originMm, {10, 20, 30}, kRounding);
    expectNear(g.indexToPhysical.column[0], {0.8, 0.6, 0}, kRounding);
    expectNear(g.indexToPhysical.column[1], {-1.2, 1.6, 0}, kRounding);
    expectNear(g.indexToPhysical.column[2], {0, 0, 5}, kRounding);
}

template <class T>
void writeWith(itk::ImageIOBase& io, const itk::Image<T, 3>& image,
               const std::filesystem::path& file, bool compress) {
    io.SetFileName(file.native());
    io.SetNumberOfDimensions(3);
    io.SetComponentType(itk::ImageIOBase::MapPixelType<T>::CType);
    io.SetPixelType(itk::IOPixelEnum::SCALAR);
    io.SetNumberOfComponents(1);
    io.SetUseCompression(compress);
    itk::ImageIORegion region(3);
    for (unsigned axis = 0; axis < 3; ++axis) {
        io.SetDimensions(axis, kSize[axis]);
        region.SetSize(axis, kSize[axis]);
        io.SetSpacing(axis, image.GetSpacing()[axis]);
        io.SetOrigin(axis, image.GetOrigin()[axis]);
        std::vector<double> direction(3);
        for (unsigned row = 0; row < 3; ++row) direction[row] = image.GetDirection()(row, axis);
        io.SetDirection(axis, direction);
    }
    io.SetIORegion(region);
    io.Write(image.GetBufferPointer());
}

template <class T>
class ItkWritten : public ::testing::Test {};
using PixelTypes =
    ::testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                     std::int32_t, std::uint64_t, std::int64_t, float, double>;
TYPED_TEST_SUITE(ItkWritten, PixelTypes);

TYPED_TEST(ItkWritten, NrrdAndMetaImageComeBackWithTypeSamplesAndGeometry) {
    const TempFolder folder;
    const auto image = makeImage<TypeParam>();
    for (const bool compress : {false, true}) {
        writeWith(*itk::NrrdImageIO::New(), *image, folder / "x.nrrd", compress);
        writeWith(*itk::MetaImageIO::New(), *image, folder / "x.mha", compress);
        for (const auto& file : {folder / "x.nrrd", folder / "x.mha"}) {
            const ReadVolume result = readVolume(file);
            ASSERT_EQ(result.volume.view().pixelType(), pixelTypeOf<TypeParam>()) << file;
            EXPECT_EQ(samplesIn<TypeParam>(result.volume), countingSamples<TypeParam>(24)) << file;
            expectObliqueGeometry(result.volume.view().geometry());
        }
    }
}

TEST(Otsu, ChoosesTheThresholdsOfItksCalculator) {
    using Histogram = itk::Statistics::Histogram<double>;
    for (const int shift : {0, 3, 17, 40}) {
        std::vector<std::uint8_t> samples;
        for (int n = 0; n < 4000; ++n) {
            const int mode = n % 7 < 3   ? 10
                             : n % 7 < 5 ? 60 + shift
                             : n % 7 < 6 ? 120
                                         : 190 - shift;
            samples.push_back(static_cast<std::uint8_t>(mode + (n * n / 7 + n * shift) % 29));
        }
        const auto [least, most] = std::minmax_element(samples.begin(), samples.end());
        const auto histogram = Histogram::New();
        histogram->SetMeasurementVectorSize(1);
        Histogram::SizeType bins(1);
        bins[0] = static_cast<itk::SizeValueType>(*most - *least + 1);
        Histogram::MeasurementVectorType lower(1), upper(1);
        lower[0] = *least - 0.5;
        upper[0] = *most + 0.5;
        histogram->Initialize(bins, lower, upper);
        for (std::size_t bin = 0; bin < bins[0]; ++bin) {
            histogram->SetFrequency(
                bin, static_cast<Histogram::AbsoluteFrequencyType>(std::count(
                         samples.begin(), samples.end(), *least + static_cast<int>(bin))));
        }
        const auto count = static_cast<std::int64_t>(samples.size());
        const auto found =
            otsuThresholds(Volume::fromSamples(std::vector(samples), {{count, 1, 1}, {}, {}}), 3);
        ASSERT_EQ(found.size(), 3U);
        for (int classes = 1; classes <= 3; ++classes) {
            const auto calculator = itk::OtsuMultipleThresholdsCalculator<Histogram>::New();
            calculator->SetInputHistogram(histogram);
            calculator->SetNumberOfThresholds(static_cast<itk::SizeValueType>(classes));
            calculator->Compute();
            for (int n = 0; n < classes; ++n) {
                const double edge = calculator->GetOutput()[n];
                double below = *least, above = *most;
                for (const std::uint8_t sample : samples) {
                    if (sample <= edge) below = std::max<double>(below, sample);
                    if (sample > edge) above = std::min<double>(above, sample);
                }
                EXPECT_EQ(found[classes - 1][n], (below + above) / 2) << shift << ' ' << classes;
            }
        }
    }
}

}  // namespace
}  // namespace adaptiso::testing
