// Everything here that needs ITK's slow headers: the adaptors, and files that ITK itself writes.
#include <gtest/gtest.h>
#include <itkMetaImageIO.h>
#include <itkNrrdImageIO.h>

#include <algorithm>

#include "Fixtures.h"
#include "adaptiso/ImageIO/ItkImageAdaptor.h"
#include "adaptiso/ImageIO/ItkMeshAdaptor.h"
#include "adaptiso/ImageIO/ReadVolume.h"

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

TEST(ItkImageAdaptor, ViewsPixelsInPlace) {
    const auto image = makeImage<float>();
    const VolumeView view = viewItkImage(*image);
    EXPECT_EQ(view.samples(), image->GetBufferPointer());
    EXPECT_EQ(view.pixelType(), PixelType::Float32);
    expectObliqueGeometry(view.geometry());
}

TEST(ItkImageAdaptor, PutsTheOriginAtTheBufferedRegionsFirstVoxel) {
    auto image = itk::Image<short, 3>::New();
    image->SetRegions(itk::ImageRegion<3>({{5, 6, 7}}, {{2, 2, 2}}));
    image->Allocate();
    expectNear(viewItkImage(*image).geometry().originMm, {5, 6, 7}, 0);
}

TEST(ItkImageAdaptor, RefusesAnImageWithoutPixels) {
    const auto image = itk::Image<short, 3>::New();
    EXPECT_THROW(viewItkImage(*image), InvalidInput);
}

TEST(ItkMeshAdaptor, KeepsPointsTrianglesAndTheirOrder) {
    TriangleMesh surface;
    surface.points = {{0, 0, 0}, {1.1, 0, 0}, {0, 2.2, 0}, {0, 0, 3.3}};
    surface.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    const auto mesh = toItkMesh(surface);
    ASSERT_EQ(mesh->GetNumberOfPoints(), 4U);
    ASSERT_EQ(mesh->GetNumberOfCells(), 4U);
    for (std::size_t id = 0; id < 4; ++id) {
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(mesh->GetPoint(id)[axis], surface.points[id][axis]);
        }
        const auto* cell = mesh->GetCells()->GetElement(id);
        ASSERT_EQ(cell->GetNumberOfPoints(), 3U);
        for (int corner = 0; corner < 3; ++corner) {
            EXPECT_EQ(cell->GetPointIds()[corner],
                      static_cast<itk::IdentifierType>(surface.triangles[id][corner]));
        }
    }
    EXPECT_EQ(toItkMesh<float>(surface)->GetPoint(1)[0], 1.1F);
}

TEST(ItkMeshAdaptor, TakesTheEmptySurface) {
    EXPECT_EQ(toItkMesh(TriangleMesh())->GetNumberOfCells(), 0U);
}

}  // namespace
}  // namespace adaptiso::testing
