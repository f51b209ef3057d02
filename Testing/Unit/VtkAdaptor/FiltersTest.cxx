#include <gtest/gtest.h>
#include <unistd.h>
#include <vtkCallbackCommand.h>
#include <vtkDoubleArray.h>
#include <vtkExecutive.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkIntArray.h>
#include <vtkLongLongArray.h>
#include <vtkMatrix3x3.h>
#include <vtkNIFTIImageReader.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSOADataArrayTemplate.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>
#include <vtkXMLPolyDataWriter.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "Support/AnalyticVolumes.h"
#include "Support/Meshes.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/Extraction/Simplify.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/VtkAdaptor/VtkAdaptor.h"
#include "adaptiso/VtkAdaptor/vtkAdaptisoIsosurface.h"
#include "adaptiso/VtkAdaptor/vtkAdaptisoSimplify.h"

namespace adaptiso {
namespace {

using testing::icosphere;
using testing::obliqueGeometry;
using testing::sampled;
using testing::sphere;

/// An image of the same samples and geometry, but for the last bits of VTK's directions.
template <class Array, class T>
vtkSmartPointer<vtkImageData> imageOf(const TypedVolumeView<T>& volume) {
    const ImageGeometry& geometry = volume.geometry;
    auto image = vtkSmartPointer<vtkImageData>::New();
    const auto last = [&](int axis) { return static_cast<int>(geometry.size[axis]) - 1; };
    image->SetExtent(0, last(0), 0, last(1), 0, last(2));
    const Vec3 spacing = geometry.spacingMm();
    image->SetSpacing(spacing.x, spacing.y, spacing.z);
    image->SetOrigin(geometry.originMm.x, geometry.originMm.y, geometry.originMm.z);
    for (int axis = 0; axis < 3; ++axis) {
        for (int row = 0; row < 3; ++row) {
            image->GetDirectionMatrix()->SetElement(
                row, axis, geometry.indexToPhysical.column[axis][row] / spacing[axis]);
        }
    }
    vtkNew<Array> scalars;
    scalars->SetName("T1");
    scalars->SetNumberOfComponents(1);
    for (std::int64_t n = 0; n < geometry.voxelCount(); ++n) {
        scalars->InsertNextValue(static_cast<typename Array::ValueType>(volume.samples[n]));
    }
    image->GetPointData()->SetScalars(scalars);
    return image;
}

/// The geometry that the filter must see, worked out from what VTK keeps.
ImageGeometry geometryIn(vtkImageData& image) {
    ImageGeometry geometry;
    for (int axis = 0; axis < 3; ++axis) {
        geometry.size[axis] = image.GetDimensions()[axis];
        geometry.originMm[axis] = image.GetOrigin()[axis];
        for (int row = 0; row < 3; ++row) {
            geometry.indexToPhysical.column[axis][row] =
                image.GetDirectionMatrix()->GetElement(row, axis) * image.GetSpacing()[axis];
        }
    }
    return geometry;
}

/// A rotation by half a turn about z: RAS to LPS.
TriangleMesh turned(TriangleMesh mesh) {
    for (Vec3& point : mesh.points) point = {-point.x, -point.y, point.z};
    for (Normal& normal : mesh.normals) normal = {-normal.x, -normal.y, normal.z};
    return mesh;
}

/// Exact, normals too: fromVtkPolyData() would scale them again.
void expectIdentical(vtkPolyData* data, const TriangleMesh& wanted) {
    const TriangleMesh mesh = fromVtkPolyData(data);
    EXPECT_EQ(mesh.points, wanted.points);
    EXPECT_EQ(mesh.triangles, wanted.triangles);
    vtkDataArray* const normals = data->GetPointData()->GetNormals();
    ASSERT_EQ(normals != nullptr, !wanted.normals.empty());
    for (std::size_t n = 0; n < wanted.normals.size(); ++n) {
        const double* const normal = normals->GetTuple3(static_cast<vtkIdType>(n));
        ASSERT_EQ(normal[0], double(wanted.normals[n].x));
        ASSERT_EQ(normal[1], double(wanted.normals[n].y));
        ASSERT_EQ(normal[2], double(wanted.normals[n].z));
    }
}

Vec3 pointOf(vtkPolyData* data, vtkIdType n) {
    Vec3 point;
    data->GetPoint(n, &point.x);
    return point;
}

/// Calls `work` and returns the texts of the error events of `filter`.
std::vector<std::string> errorsOf(vtkAlgorithm* filter, const std::function<void()>& work) {
    std::vector<std::string> errors;
    vtkNew<vtkCallbackCommand> listener;
    listener->SetClientData(&errors);
    listener->SetCallback([](vtkObject*, unsigned long, void* client, void* text) {
        static_cast<std::vector<std::string>*>(client)->emplace_back(static_cast<char*>(text));
    });
    const unsigned long tag = filter->AddObserver(vtkCommand::ErrorEvent, listener);
    const unsigned long own = filter->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, listener);
    work();
    filter->GetExecutive()->RemoveObserver(own);
    filter->RemoveObserver(tag);
    return errors;
}

const auto kBall = [] {
    return sampled<float>(sphere({}, 11), obliqueGeometry({32, 30, 28}, {1, 1.1, 1.2}));
};

TEST(VtkIsosurface, IsTheLibrarysMeshToTheBit) {
    const auto ball = kBall();
    const auto image = imageOf<vtkFloatArray>(ball.volume.view().as<float>());
    const VolumeView lps(ball.volume.view().samples(), PixelType::Float32, geometryIn(*image));
    ExtractionOptions options;
    options.isovalue = ball.isovalue;
    const Extraction wanted = extractSurface(lps, options);
    ASSERT_GT(wanted.mesh.triangles.size(), 100U);

    vtkNew<vtkAdaptisoIsosurface> filter;
    filter->SetInputData(image);
    filter->SetValue(0, ball.isovalue);
    filter->SetCoordinateFrameToLPS();
    filter->Update();
    expectIdentical(filter->GetOutput(), wanted.mesh);
    EXPECT_EQ(filter->GetOutput()->GetFieldData()->GetArray("ErrorBound")->GetTuple1(0),
              *wanted.statistics.errorBoundMm);

    // an image in RAS is made in LPS, as the program makes a NIfTI's
    ImageGeometry ras = geometryIn(*image);
    for (Vec3* each : {&ras.originMm, &ras.indexToPhysical.column[0],
                       &ras.indexToPhysical.column[1], &ras.indexToPhysical.column[2]}) {
        *each = {-each->x, -each->y, each->z};
    }
    filter->SetCoordinateFrameToRAS();
    filter->Update();
    const VolumeView rasView(ball.volume.view().samples(), PixelType::Float32, ras);
    expectIdentical(filter->GetOutput(), turned(extractSurface(rasView, options).mesh));
}

TEST(VtkIsosurface, TakesEveryScalarTypeAndLayout) {
    const auto ball = sampled<std::uint8_t>(sphere({}, 11), testing::centredGeometry({28, 28, 28}));
    const auto samples = ball.volume.view().as<std::uint8_t>();
    const auto meshOf = [&](vtkImageData* image) {
        vtkNew<vtkAdaptisoIsosurface> filter;
        filter->SetInputData(image);
        filter->SetValue(0, ball.isovalue);
        filter->Update();
        return fromVtkPolyData(filter->GetOutput());
    };
    const TriangleMesh wanted = meshOf(imageOf<vtkUnsignedCharArray>(samples));
    ASSERT_GT(wanted.triangles.size(), 100U);
    EXPECT_EQ(meshOf(imageOf<vtkLongLongArray>(samples)), wanted);
    EXPECT_EQ(meshOf(imageOf<vtkDoubleArray>(samples)), wanted);
    EXPECT_EQ(meshOf(imageOf<vtkSOADataArrayTemplate<short>>(samples)), wanted);

    // the corner of the image may have any index
    const auto moved = imageOf<vtkUnsignedCharArray>(samples);
    moved->SetExtent(5, 32, -3, 24, 7, 34);
    moved->SetOrigin(moved->GetOrigin()[0] - 5, moved->GetOrigin()[1] + 3,
                     moved->GetOrigin()[2] - 7);
    EXPECT_EQ(meshOf(moved), wanted);
}

TEST(VtkIsosurface, SeveralValuesFollowOneAnother) {
    const auto ball = kBall();
    const auto image = imageOf<vtkFloatArray>(ball.volume.view().as<float>());
    vtkNew<vtkAdaptisoIsosurface> filter;
    filter->SetInputData(image);
    filter->GenerateValues(3, ball.isovalue - 2, ball.isovalue + 2);
    filter->ComputeNormalsOff();
    filter->Update();
    vtkPolyData* const all = filter->GetOutput();
    EXPECT_EQ(all->GetPointData()->GetNormals(), nullptr);
    vtkDataArray* const scalars = all->GetPointData()->GetScalars();
    ASSERT_NE(scalars, nullptr);
    EXPECT_STREQ(scalars->GetName(), "T1");
    // depth is the radius less the distance from the middle: value 64 + d has radius 11 - d
    for (vtkIdType n = 0; n < all->GetNumberOfPoints(); ++n) {
        ASSERT_NEAR(norm(pointOf(all, n)), 11 - (scalars->GetTuple1(n) - 64), 0.2);
    }
    EXPECT_EQ(scalars->GetRange()[0], 62);
    EXPECT_EQ(scalars->GetRange()[1], 66);
    EXPECT_EQ(all->GetFieldData()->GetArray("ErrorBound")->GetNumberOfTuples(), 3);
    const TriangleMesh mesh = fromVtkPolyData(all);
    EXPECT_NEAR(enclosedVolume(mesh), 4.0 / 3 * M_PI * (13 * 13 * 13 + 11 * 11 * 11 + 9 * 9 * 9),
                500);  // 3 %: the bound of 0.15 mm on all three

    filter->SetValue(0, 1e6);  // never reached: no surface, and the others stay
    filter->ComputeScalarsOff();
    filter->Update();
    EXPECT_EQ(all->GetPointData()->GetScalars(), nullptr);
    EXPECT_GT(all->GetNumberOfPoints(), 0);
    EXPECT_EQ(all->GetFieldData()->GetArray("ErrorBound")->GetTuple1(0), 0);
}

TEST(VtkIsosurface, KeepsBoundAndCount) {
    const auto ball = kBall();
    vtkNew<vtkAdaptisoIsosurface> filter;
    filter->SetInputData(imageOf<vtkFloatArray>(ball.volume.view().as<float>()));
    filter->SetValue(0, ball.isovalue);
    filter->SetMaximumError(0.02);
    filter->Update();
    const auto boundOf = [&] {
        return filter->GetOutput()->GetFieldData()->GetArray("ErrorBound")->GetTuple1(0);
    };
    const vtkIdType fine = filter->GetOutput()->GetNumberOfPolys();
    EXPECT_LE(boundOf(), 0.02);
    EXPECT_GT(boundOf(), 0);
    filter->SetMaximumError(0.5);
    filter->Update();
    EXPECT_LE(boundOf(), 0.5);
    EXPECT_LT(filter->GetOutput()->GetNumberOfPolys(), fine);

    ExtractionOptions full;
    full.isovalue = ball.isovalue;
    full.method = Method::MarchingCubes;
    const auto most = static_cast<double>(extractSurface(ball.volume, full).mesh.triangles.size());
    filter->SetMaximumError(0);
    filter->SetTargetReduction(0.95);
    filter->Update();
    EXPECT_LE(filter->GetOutput()->GetNumberOfPolys(), 0.05 * most + 1);
    EXPECT_GT(filter->GetOutput()->GetNumberOfPolys(), 0.04 * most);
}

TEST(VtkIsosurface, FilesOfVtksWriterSayTheFrame) {
    const auto ball = kBall();
    const auto image = imageOf<vtkFloatArray>(ball.volume.view().as<float>());
    vtkNew<vtkAdaptisoIsosurface> filter;
    filter->SetInputData(image);
    filter->SetValue(0, ball.isovalue);
    const auto file = std::filesystem::temp_directory_path() /
                      ("adaptiso-vtk-frame-" + std::to_string(getpid()) + ".vtp");
    const auto frameOfFile = [&] {
        vtkNew<vtkXMLPolyDataWriter> writer;
        writer->SetInputConnection(filter->GetOutputPort());
        writer->SetFileName(file.c_str());
        EXPECT_EQ(writer->Write(), 1);
        return readMesh(file).frame;
    };
    EXPECT_EQ(frameOfFile(), std::nullopt);  // nobody has said it
    filter->SetCoordinateFrameToRAS();
    EXPECT_EQ(frameOfFile(), CoordinateFrame::Ras);
    filter->SetCoordinateFrame(vtkAdaptisoIsosurface::FRAME_UNKNOWN);
    vtkNew<vtkStringArray> space;
    space->SetName("SPACE");
    space->InsertNextValue("LPS");
    image->GetFieldData()->AddArray(space);
    image->Modified();
    EXPECT_EQ(frameOfFile(), CoordinateFrame::Lps);
    std::filesystem::remove(file);
}

TEST(VtkIsosurface, TellsProgressAndCanBeAborted) {
    const auto ball = kBall();
    vtkNew<vtkAdaptisoIsosurface> filter;
    filter->SetInputData(imageOf<vtkFloatArray>(ball.volume.view().as<float>()));
    filter->GenerateValues(2, ball.isovalue, ball.isovalue + 1);
    std::vector<double> seen;
    vtkNew<vtkCallbackCommand> listener;
    listener->SetClientData(&seen);
    listener->SetCallback([](vtkObject* caller, unsigned long, void* client, void*) {
        static_cast<std::vector<double>*>(client)->push_back(
            static_cast<vtkAlgorithm*>(caller)->GetProgress());
    });
    filter->AddObserver(vtkCommand::ProgressEvent, listener);
    filter->Update();
    ASSERT_GT(seen.size(), 4U);
    EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end() - 1));
    EXPECT_NEAR(seen[seen.size() - 2], 1, 0.01);
    EXPECT_GT(filter->GetOutput()->GetNumberOfPolys(), 0);

    vtkNew<vtkCallbackCommand> stopper;
    stopper->SetCallback([](vtkObject* caller, unsigned long, void*, void*) {
        auto* const algorithm = static_cast<vtkAlgorithm*>(caller);
        if (algorithm->GetProgress() > 0.2) algorithm->AbortExecuteOn();
    });
    const unsigned long stop = filter->AddObserver(vtkCommand::ProgressEvent, stopper);
    filter->Modified();
    seen.clear();
    EXPECT_EQ(errorsOf(filter, [&] { filter->Update(); }), std::vector<std::string>{});
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPolys(), 0);
    if (!seen.empty() && seen.back() == 1) seen.pop_back();  // VTK 9.3's own
    ASSERT_FALSE(seen.empty());
    EXPECT_LT(*std::max_element(seen.begin(), seen.end()), 0.6);
    vtkNew<vtkAdaptisoSimplify> downstream;
    downstream->SetInputConnection(filter->GetOutputPort());
    downstream->SetMaximumError(0.5);
    EXPECT_EQ(errorsOf(downstream, [&] { downstream->Update(); }), std::vector<std::string>{});
    EXPECT_EQ(downstream->GetOutput()->GetNumberOfPolys(), 0);

    filter->RemoveObserver(stop);
    filter->AbortExecuteOff();  // VTK 9.1 does it itself
    filter->Modified();
    downstream->Update();
    EXPECT_GT(filter->GetOutput()->GetNumberOfPolys(), 0);
    EXPECT_GT(downstream->GetOutput()->GetNumberOfPolys(), 0);
}

TEST(VtkIsosurface, InputThatCannotBeUsedIsOneError) {
    const auto ball = kBall();
    const auto image = imageOf<vtkFloatArray>(ball.volume.view().as<float>());
    vtkNew<vtkAdaptisoIsosurface> filter;
    filter->SetInputData(image);
    const auto expectError = [&](const std::string& part) {
        image->Modified();
        const std::vector<std::string> errors = errorsOf(filter, [&] { filter->Update(); });
        ASSERT_FALSE(errors.empty());
        EXPECT_NE(errors.front().find(part), std::string::npos) << errors.front();
        EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0);
    };
    filter->SetValue(0, std::nan(""));
    expectError("isovalue");
    filter->SetValue(0, ball.isovalue);
    image->SetSpacing(1, 0, 1);
    expectError("span");
    image->SetSpacing(1, 1, 1);
    vtkNew<vtkFloatArray> vectors;
    vectors->SetNumberOfComponents(3);
    vectors->SetNumberOfTuples(image->GetNumberOfPoints());
    vectors->Fill(0);
    image->GetPointData()->SetScalars(vectors);
    expectError("3 components");
    image->GetPointData()->SetScalars(nullptr);
    expectError("scalars");
}

// The quickstart's scan through VTK's own reader, and both filters: counts as adaptiso-mesh
// prints them in the README.
TEST(VtkIsosurface, QuickstartScanThroughVtksReader) {
    const std::filesystem::path scan = "/usr/share/mricron/templates/ch2bet.nii.gz";
    if (!std::filesystem::exists(scan)) GTEST_SKIP() << "needs Debian's mricron-data";
    vtkNew<vtkNIFTIImageReader> reader;
    reader->SetFileName(scan.c_str());
    vtkNew<vtkAdaptisoIsosurface> isosurface;
    isosurface->SetInputConnection(reader->GetOutputPort());
    isosurface->SetValue(0, 100);
    vtkNew<vtkAdaptisoSimplify> simplify;
    simplify->SetInputConnection(isosurface->GetOutputPort());
    simplify->SetMaximumError(0.3);
    simplify->Update();
    EXPECT_EQ(isosurface->GetOutput()->GetNumberOfPolys(), 228'714);
    EXPECT_EQ(isosurface->GetOutput()->GetNumberOfPoints(), 114'769);
    EXPECT_LE(isosurface->GetOutput()->GetFieldData()->GetArray("ErrorBound")->GetTuple1(0), 0.15);
    EXPECT_LT(simplify->GetOutput()->GetNumberOfPolys(), 228'714 / 2);
    EXPECT_LE(simplify->GetOutput()->GetFieldData()->GetArray("ErrorBound")->GetTuple1(0), 0.3);
}

TEST(VtkSimplify, IsTheLibrarysMeshToTheBit) {
    const TriangleMesh fine = icosphere(4, {1, 2, 3}, 20);
    vtkNew<vtkAdaptisoSimplify> filter;
    filter->SetInputData(toVtkPolyData(fine));
    filter->SetMaximumError(0.3);
    filter->Update();
    SimplifyOptions options;
    options.maxErrorMm = 0.3;
    const Simplified wanted = simplify(fromVtkPolyData(toVtkPolyData(fine)), options);
    expectIdentical(filter->GetOutput(), wanted.mesh);
    EXPECT_LT(wanted.mesh.triangles.size() * 4, fine.triangles.size());
    EXPECT_EQ(filter->GetOutput()->GetFieldData()->GetArray("ErrorBound")->GetTuple1(0),
              wanted.statistics.errorBoundMm);
}

TEST(VtkSimplify, PointDataComeAlong) {
    const auto data = toVtkPolyData(icosphere(4, {}, 20));
    vtkNew<vtkFloatArray> height;
    height->SetName("height");
    vtkNew<vtkIntArray> label;
    label->SetName("label");
    vtkNew<vtkUnsignedCharArray> color;
    color->SetName("color");
    color->SetNumberOfComponents(3);
    vtkNew<vtkStringArray> side;
    side->SetName("side");
    for (vtkIdType n = 0; n < data->GetNumberOfPoints(); ++n) {
        const Vec3 point = pointOf(data, n);
        height->InsertNextValue(static_cast<float>(point.z));
        label->InsertNextValue(point.x < 0 ? 7 : 1000);
        color->InsertNextTuple3(100 + 5 * point.y, 0, 255);
        side->InsertNextValue(point.x < 0 ? "left" : "right");
    }
    for (vtkAbstractArray* each :
         {static_cast<vtkAbstractArray*>(height), static_cast<vtkAbstractArray*>(color),
          static_cast<vtkAbstractArray*>(side)}) {
        data->GetPointData()->AddArray(each);
    }
    data->GetPointData()->SetScalars(label);
    vtkNew<vtkStringArray> space;
    space->SetName("SPACE");
    space->InsertNextValue("RAS");
    data->GetFieldData()->AddArray(space);

    vtkNew<vtkAdaptisoSimplify> filter;
    filter->SetInputData(data);
    filter->SetTargetReduction(0.8);
    filter->Update();
    vtkPolyData* const made = filter->GetOutput();
    vtkPointData& values = *made->GetPointData();
    EXPECT_LE(made->GetNumberOfPolys(), 1024);  // a fifth of 5120
    EXPECT_GT(made->GetNumberOfPolys(), 1000);
    EXPECT_STREQ(values.GetScalars()->GetName(), "label");
    EXPECT_NE(values.GetNormals(), nullptr);
    EXPECT_NE(made->GetFieldData()->GetAbstractArray("SPACE"), nullptr);
    auto* const sides = vtkStringArray::SafeDownCast(values.GetAbstractArray("side"));
    const double bound = made->GetFieldData()->GetArray("ErrorBound")->GetTuple1(0);
    for (vtkIdType n = 0; n < made->GetNumberOfPoints(); ++n) {
        const Vec3 point = pointOf(made, n);
        // a linear function on flat triangles: off by the way to the input, at most the bound
        ASSERT_NEAR(values.GetArray("height")->GetTuple1(n), point.z, bound + 1e-5);
        ASSERT_NEAR(values.GetArray("color")->GetTuple3(n)[0], 100 + 5 * point.y, 5 * bound + 1.5);
        ASSERT_EQ(values.GetArray("color")->GetTuple3(n)[2], 255);
        const double found = values.GetArray("label")->GetTuple1(n);
        ASSERT_TRUE(found == 7 || found == 1000);
        ASSERT_EQ(sides->GetValue(n), found == 7 ? "left" : "right");
        // input edges are shorter than 2 mm
        if (std::abs(point.x) > 2) {
            ASSERT_EQ(found, point.x < 0 ? 7 : 1000);
        }
    }
}

TEST(VtkSimplify, InputThatCannotBeUsedIsOneError) {
    vtkNew<vtkAdaptisoSimplify> filter;
    filter->SetInputData(vtkSmartPointer<vtkPolyData>::New());
    EXPECT_EQ(errorsOf(filter, [&] { filter->Update(); }), std::vector<std::string>{});
    filter->SetInputData(toVtkPolyData(icosphere(1)));  // neither bound nor count
    EXPECT_FALSE(errorsOf(filter, [&] { filter->Update(); }).empty());
    filter->SetMaximumError(0.1);
    const auto quad = toVtkPolyData(icosphere(1));
    vtkNew<vtkCellArray> cells;
    cells->InsertNextCell({0, 1, 2, 3});
    quad->SetPolys(cells);
    filter->SetInputData(quad);
    const auto errors = errorsOf(filter, [&] { filter->Update(); });
    ASSERT_FALSE(errors.empty());
    EXPECT_NE(errors.front().find("vtkTriangleFilter"), std::string::npos);
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0);
}

}  // namespace
}  // namespace adaptiso
