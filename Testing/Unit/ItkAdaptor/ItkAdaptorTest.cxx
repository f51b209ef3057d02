// ITK's headers take long to compile: all tests of the module are here.
#include <gtest/gtest.h>
#include <itkAddImageAdaptor.h>
#include <itkCommand.h>
#include <itkImageFileReader.h>
#include <itkMetaDataObject.h>
#include <itkQuadEdgeMesh.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "Support/AnalyticVolumes.h"
#include "adaptiso/ItkAdaptor/AdaptiveIsosurfaceMeshFilter.h"
#include "adaptiso/ItkAdaptor/ItkImageIO.h"

namespace adaptiso::testing {
namespace {

/// Oblique about z by the angle of the 3-4-5 triangle, anisotropic, its first voxel at (5, -6, 7).
template <class T>
typename itk::Image<T, 3>::Pointer makeImage(int size, T value(const Vec3&)) {
    auto image = itk::Image<T, 3>::New();
    const auto length = static_cast<itk::SizeValueType>(size);
    image->SetRegions(itk::ImageRegion<3>({{5, -6, 7}}, {{length, length, length}}));
    image->Allocate();
    const double spacing[] = {1, 1.2, 1.5}, origin[] = {10, 20, 30};
    image->SetSpacing(spacing);
    image->SetOrigin(origin);
    typename itk::Image<T, 3>::DirectionType direction;
    direction.SetIdentity();
    direction(0, 0) = direction(1, 1) = 0.8;
    direction(0, 1) = -0.6;
    direction(1, 0) = 0.6;
    image->SetDirection(direction);
    const double middle = (size - 1) / 2.0;
    T* sample = image->GetBufferPointer();
    for (int k = 0; k < size; ++k) {
        for (int j = 0; j < size; ++j) {
            for (int i = 0; i < size; ++i) {
                *sample++ = value({i - middle, 1.2 * (j - middle), 1.5 * (k - middle)});
            }
        }
    }
    return image;
}

/// 60 at 9 mm from the middle, more inside.
template <class T>
T ballValue(const Vec3& fromMiddleMm) {
    return static_cast<T>(std::clamp(60 + 6 * (9 - norm(fromMiddleMm)), 0.0, 120.0));
}

template <class Mesh>
void expectSame(const Mesh& mesh, const TriangleMesh& wanted) {
    ASSERT_EQ(mesh.GetNumberOfPoints(), wanted.points.size());
    ASSERT_EQ(mesh.GetNumberOfCells(), wanted.triangles.size());
    for (std::size_t id = 0; id < wanted.points.size(); ++id) {
        for (int axis = 0; axis < 3; ++axis) {
            ASSERT_EQ(mesh.GetPoint(id)[axis], wanted.points[id][axis]);
        }
    }
    for (std::size_t id = 0; id < wanted.triangles.size(); ++id) {
        const auto* cell = mesh.GetCells()->GetElement(id);
        ASSERT_EQ(cell->GetNumberOfPoints(), 3U);
        for (int corner = 0; corner < 3; ++corner) {
            ASSERT_EQ(cell->GetPointIds()[corner],
                      static_cast<itk::IdentifierType>(wanted.triangles[id][corner]));
        }
    }
}

template <class T>
class ItkFilterOf : public ::testing::Test {};
using ScalarTypes =
    ::testing::Types<char, unsigned char, short, unsigned int, long long, float, double>;
TYPED_TEST_SUITE(ItkFilterOf, ScalarTypes);

TYPED_TEST(ItkFilterOf, IsTheLibrarysMeshToTheBit) {
    const auto image = makeImage<TypeParam>(24, ballValue<TypeParam>);
    ExtractionOptions options;
    options.isovalue = 60;
    const VolumeView view = viewItkImage(*image);
    EXPECT_EQ(view.samples(), image->GetBufferPointer());
    const Extraction wanted = extractSurface(view, options);
    ASSERT_GT(wanted.mesh.triangles.size(), 100U);

    auto filter = AdaptiveIsosurfaceMeshFilter<itk::Image<TypeParam, 3>>::New();
    filter->SetInput(image);
    filter->SetIsovalue(60);
    filter->Update();
    expectSame(*filter->GetOutput(), wanted.mesh);
    EXPECT_EQ(filter->GetErrorBound(), *wanted.statistics.errorBoundMm);
    // at the middle of the image, where ITK has it
    itk::ContinuousIndex<double, 3> middleIndex;
    middleIndex[0] = 16.5;
    middleIndex[1] = 5.5;
    middleIndex[2] = 18.5;
    itk::Point<double, 3> middle;
    image->TransformContinuousIndexToPhysicalPoint(middleIndex, middle);
    for (const Vec3& point : wanted.mesh.points) {
        ASSERT_NEAR(norm(point - Vec3{middle[0], middle[1], middle[2]}), 9, 0.4);
    }
}

using FloatImage = itk::Image<float, 3>;
using Filter = AdaptiveIsosurfaceMeshFilter<FloatImage>;

/// Calls `work` at every progress event of `filter`.
void onProgress(itk::ProcessObject* filter, std::function<void()> work) {
    auto command = itk::FunctionCommand::New();
    command->SetCallback([work = std::move(work)](const itk::EventObject&) { work(); });
    filter->AddObserver(itk::ProgressEvent(), command);
}

TEST(ItkFilter, QuadEdgeMeshIsClosed) {
    using Mesh = itk::QuadEdgeMesh<double, 3>;
    auto filter = AdaptiveIsosurfaceMeshFilter<FloatImage, Mesh>::New();
    filter->SetInput(makeImage<float>(24, ballValue<float>));
    filter->SetIsovalue(60);
    filter->Update();
    const Mesh& mesh = *filter->GetOutput();
    const auto points = mesh.GetNumberOfPoints(), faces = mesh.GetNumberOfFaces(),
               edges = mesh.GetNumberOfEdges();
    EXPECT_GT(faces, 100U);
    EXPECT_EQ(2 * edges, 3 * faces);       // no edge is open
    EXPECT_EQ(points + faces, edges + 2);  // a sphere
}

TEST(ItkFilter, OtherImagesAreCopied) {
    const auto image = makeImage<float>(24, ballValue<float>);
    using Shifted = itk::AddImageAdaptor<FloatImage>;
    auto shifted = Shifted::New();
    shifted->SetImage(image);
    shifted->SetValue(1000);
    auto filter = AdaptiveIsosurfaceMeshFilter<Shifted>::New();
    filter->SetInput(shifted);
    filter->SetIsovalue(1060);
    auto plain = Filter::New();
    plain->SetInput(image);
    plain->SetIsovalue(60);
    filter->Update();
    plain->Update();
    // sums of float are rounded: a crossing moves by 1e-5 mm
    EXPECT_NEAR(static_cast<double>(filter->GetOutput()->GetNumberOfCells()),
                static_cast<double>(plain->GetOutput()->GetNumberOfCells()), 20);
    EXPECT_GT(filter->GetOutput()->GetNumberOfCells(), 100U);
}

TEST(ItkFilter, KeepsBoundCountAndBorder) {
    auto filter = Filter::New();
    filter->SetInput(makeImage<float>(24, ballValue<float>));
    filter->SetIsovalue(60);
    filter->SetMaxError(0.02);
    filter->Update();
    const auto fine = filter->GetOutput()->GetNumberOfCells();
    EXPECT_LE(filter->GetErrorBound(), 0.02);
    EXPECT_GT(filter->GetErrorBound(), 0);
    filter->SetMaxError(0);
    filter->SetNumberOfTriangles(300);
    filter->Update();
    EXPECT_LE(filter->GetOutput()->GetNumberOfCells(), 300U);
    EXPECT_GT(filter->GetOutput()->GetNumberOfCells(), 250U);
    EXPECT_LT(300U, fine);

    // a plane that ends at the image's border: with a closed border a solid
    filter->SetInput(makeImage<float>(
        12, +[](const Vec3& at) { return float(at.z); }));
    filter->SetIsovalue(0.3);
    filter->SetNumberOfTriangles(0);
    filter->Update();
    const auto closed = filter->GetOutput()->GetNumberOfCells();
    filter->ClosedBorderOff();
    filter->Update();
    EXPECT_GT(filter->GetOutput()->GetNumberOfCells(), 0U);
    EXPECT_LT(filter->GetOutput()->GetNumberOfCells(), closed);
}

TEST(ItkFilter, TellsProgressAndCanBeAborted) {
    auto filter = Filter::New();
    filter->SetInput(makeImage<float>(40, ballValue<float>));
    filter->SetIsovalue(60);
    std::vector<float> seen;
    onProgress(filter, [&] { seen.push_back(filter->GetProgress()); });
    filter->Update();
    ASSERT_GE(seen.size(), 3U);
    EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
    EXPECT_NEAR(seen.back(), 1, 0.01);

    onProgress(filter, [&] {
        if (filter->GetProgress() > 0.2F) filter->AbortGenerateDataOn();
    });
    filter->SetIsovalue(61);
    EXPECT_THROW(filter->Update(), itk::ProcessAborted);
}

TEST(ItkFilter, RefusalsAreExceptionsWithTheLine) {
    auto filter = Filter::New();
    filter->SetInput(makeImage<float>(8, ballValue<float>));
    filter->SetIsovalue(std::nan(""));
    try {
        filter->Update();
        FAIL() << "NaN was taken";
    } catch (const itk::ExceptionObject& error) {
        EXPECT_EQ(std::string(error.GetDescription()),
                  "extractSurface: the isovalue is not a finite number");
    }
}

/// A NIfTI of 3 x 2 x 2 voxels of 16 bits, 0 to 11, without sform and qform: a warning.
std::filesystem::path writeNifti(std::size_t samples = 12) {
    const auto file = std::filesystem::temp_directory_path() /
                      ("adaptiso-itk-" + std::to_string(getpid()) + ".nii");
    std::string head(352, '\0');
    const auto put = [&](std::size_t at, auto value) {
        std::memcpy(head.data() + at, &value, sizeof value);
    };
    put(0, std::int32_t{348});
    std::size_t at = 40;
    for (const int value : {3, 3, 2, 2, 1, 1, 1, 1}) {
        put(std::exchange(at, at + 2), static_cast<std::int16_t>(value));
    }
    put(70, std::int16_t{4});
    put(72, std::int16_t{16});
    at = 76;
    for (const float value : {1.F, 2.F, 3.F, 4.F}) put(std::exchange(at, at + 4), value);
    put(108, 352.F);
    head.replace(344, 4, std::string("n+1\0", 4));
    std::ofstream out(file, std::ios::binary);
    out << head;
    for (std::int16_t n = 0; n < static_cast<std::int16_t>(samples); ++n) {
        out.write(reinterpret_cast<const char*>(&n), 2);
    }
    return file;
}

TEST(ItkImageIo, ReadsWithSpacingWarningsAndFormat) {
    registerItkImageIO();
    const auto file = writeNifti();
    auto reader = itk::ImageFileReader<itk::Image<short, 3>>::New();
    reader->SetFileName(file.string());
    reader->Update();
    ASSERT_NE(dynamic_cast<ItkImageIO*>(reader->GetImageIO()), nullptr);
    const auto& image = *reader->GetOutput();
    EXPECT_EQ(image.GetSpacing()[0], 2);
    EXPECT_EQ(image.GetSpacing()[2], 4);
    for (short n = 0; n < 12; ++n) ASSERT_EQ(image.GetBufferPointer()[n], n);
    std::string text;
    EXPECT_TRUE(itk::ExposeMetaData(image.GetMetaDataDictionary(), "adaptiso.format", text));
    EXPECT_EQ(text, "NIfTI-1");
    EXPECT_TRUE(itk::ExposeMetaData(image.GetMetaDataDictionary(), "adaptiso.warnings", text));
    EXPECT_EQ(text, readVolume(file).warnings.front().line());

    // a slice of it, for a reader of two dimensions
    auto slice = itk::ImageFileReader<itk::Image<short, 2>>::New();
    slice->SetFileName(file.string());
    slice->Update();
    EXPECT_EQ(slice->GetOutput()->GetBufferPointer()[5], 5);
    std::filesystem::remove(file);
}

TEST(ItkImageIo, RefusalsAreExceptionsWithTheLine) {
    registerItkImageIO();
    const auto file = writeNifti(11);
    std::string line;
    try {
        readVolume(file);
    } catch (const FileError& error) {
        line = error.what();
    }
    auto reader = itk::ImageFileReader<itk::Image<short, 3>>::New();
    reader->SetFileName(file.string());
    try {
        reader->Update();
        FAIL() << "a cut file was taken";
    } catch (const itk::ExceptionObject& error) {
        EXPECT_NE(std::string(error.GetDescription()).find(line), std::string::npos);
        EXPECT_NE(line, "");
    }
    std::filesystem::remove(file);
}

TEST(ItkImageAdaptor, ViewsPixelsInPlaceWhereTheBufferedRegionLies) {
    const auto image = makeImage<float>(4, ballValue<float>);
    const VolumeView view = viewItkImage(*image);
    EXPECT_EQ(view.samples(), image->GetBufferPointer());
    EXPECT_EQ(view.pixelType(), PixelType::Float32);
    const ImageGeometry& g = view.geometry();
    constexpr double kRounding = 1e-12;
    EXPECT_EQ(g.size, (Index3{4, 4, 4}));
    // 5 steps along the first axis, -6 along the second, 7 along the third
    EXPECT_LE(norm(g.originMm - Vec3{10 + 4 + 4.32, 20 + 3 - 5.76, 30 + 10.5}), kRounding);
    EXPECT_LE(norm(g.indexToPhysical.column[0] - Vec3{0.8, 0.6, 0}), kRounding);
    EXPECT_LE(norm(g.indexToPhysical.column[1] - Vec3{-0.72, 0.96, 0}), kRounding);
    EXPECT_LE(norm(g.indexToPhysical.column[2] - Vec3{0, 0, 1.5}), kRounding);
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
