// Reads one image with this library, in the sandbox process and without it, as an ITK ImageIO, and
// with ITK alone; or, with --iso, makes its surface by extractSurface() and by the filters for ITK
// and VTK: in turn within one process. Testing/Benchmark/README.md explains the columns.
#include <itkGDCMImageIO.h>
#include <itkGDCMSeriesFileNames.h>
#include <itkImageFileReader.h>
#include <itkImageSeriesReader.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <sys/resource.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkMatrix3x3.h>
#include <vtkPointData.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/ItkAdaptor/AdaptiveIsosurfaceMeshFilter.h"
#include "adaptiso/ItkAdaptor/ItkImageAdaptor.h"
#include "adaptiso/ItkAdaptor/ItkImageIO.h"
#include "adaptiso/VtkAdaptor/vtkAdaptisoIsosurface.h"

namespace {

namespace fs = std::filesystem;
using adaptiso::ReadOptions;

/// Looks at every sample too, as any use of an image does.
template <class T>
void readWithItk(const fs::path& input) {
    using Image = itk::Image<T, 3>;
    if (fs::is_directory(input)) {
        auto names = itk::GDCMSeriesFileNames::New();
        names->SetDirectory(input.native());
        auto reader = itk::ImageSeriesReader<Image>::New();
        reader->SetImageIO(itk::GDCMImageIO::New());
        reader->SetFileNames(names->GetInputFileNames());
        reader->Update();
        adaptiso::valueRange(adaptiso::viewItkImage(*reader->GetOutput()));
        return;
    }
    auto reader = itk::ImageFileReader<Image>::New();
    reader->SetFileName(input.native());
    const std::string name = input.filename().native();
    if (name.ends_with(".nii") || name.ends_with(".nii.gz")) {
        reader->SetImageIO(itk::NiftiImageIO::New());
    } else if (name.ends_with(".nrrd") || name.ends_with(".nhdr")) {
        reader->SetImageIO(itk::NrrdImageIO::New());
    } else {
        reader->SetImageIO(itk::MetaImageIO::New());
    }
    reader->Update();
    adaptiso::valueRange(adaptiso::viewItkImage(*reader->GetOutput()));
}

/// The same image by our own ImageIO.
template <class T>
void readPlugged(const fs::path& input) {
    auto reader = itk::ImageFileReader<itk::Image<T, 3>>::New();
    reader->SetFileName(input.native());
    reader->SetImageIO(adaptiso::ItkImageIO::New());
    reader->Update();
    adaptiso::valueRange(adaptiso::viewItkImage(*reader->GetOutput()));
}

/// As the ITK filter makes it, from the same samples.
template <class T>
void extractByItk(const adaptiso::VolumeView& view, double isovalue) {
    using Image = itk::Image<T, 3>;
    auto image = Image::New();
    typename Image::SizeType size;
    typename Image::PointType origin;
    typename Image::SpacingType spacing;
    typename Image::DirectionType direction;
    const adaptiso::ImageGeometry& geometry = view.geometry();
    for (unsigned axis = 0; axis < 3; ++axis) {
        const auto n = static_cast<int>(axis);
        size[axis] = static_cast<itk::SizeValueType>(geometry.size[axis]);
        origin[axis] = geometry.originMm[n];
        spacing[axis] = geometry.spacingMm()[n];
        for (int row = 0; row < 3; ++row) {
            direction(row, axis) = geometry.indexToPhysical.column[axis][row] / spacing[axis];
        }
    }
    image->SetRegions(size);
    image->SetOrigin(origin);
    image->SetSpacing(spacing);
    image->SetDirection(direction);
    image->GetPixelContainer()->SetImportPointer(
        const_cast<T*>(static_cast<const T*>(view.samples())),
        static_cast<itk::SizeValueType>(geometry.voxelCount()), false);
    auto filter = adaptiso::AdaptiveIsosurfaceMeshFilter<Image>::New();
    filter->SetInput(image);
    filter->SetIsovalue(isovalue);
    filter->Update();
}

/// As the VTK filter makes it, without normals, from the same samples.
template <class T>
void extractByVtk(const adaptiso::VolumeView& view, double isovalue) {
    const adaptiso::ImageGeometry& geometry = view.geometry();
    vtkNew<vtkImageData> image;
    image->SetDimensions(static_cast<int>(geometry.size[0]), static_cast<int>(geometry.size[1]),
                         static_cast<int>(geometry.size[2]));
    image->SetOrigin(&geometry.originMm.x);
    const adaptiso::Vec3 spacing = geometry.spacingMm();
    image->SetSpacing(&spacing.x);
    for (int axis = 0; axis < 3; ++axis) {
        for (int row = 0; row < 3; ++row) {
            image->GetDirectionMatrix()->SetElement(
                row, axis,
                geometry.indexToPhysical.column[static_cast<std::size_t>(axis)][row] /
                    spacing[axis]);
        }
    }
    const auto scalars = vtkSmartPointer<vtkDataArray>::Take(
        vtkDataArray::CreateDataArray(vtkTypeTraits<T>::VTK_TYPE_ID));
    scalars->SetVoidArray(const_cast<void*>(view.samples()), geometry.voxelCount(), 1);
    image->GetPointData()->SetScalars(scalars);
    vtkNew<vtkAdaptisoIsosurface> filter;
    filter->SetInputData(image);
    filter->SetValue(0, isovalue);
    filter->SetCoordinateFrameToLPS();
    filter->ComputeNormalsOff();
    filter->ComputeScalarsOff();
    filter->Update();
}

/// Processor seconds, user and system, of this process and its children.
double secondsOf(const std::function<void()>& work) {
    const auto now = [] {
        double seconds = 0;
        for (const int whose : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
            rusage usage{};
            getrusage(whose, &usage);
            for (const timeval& time : {usage.ru_utime, usage.ru_stime}) {
                seconds +=
                    static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
            }
        }
        return seconds;
    };
    const double begin = now();
    work();
    return now() - begin;
}

double median(std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
}

/// This process's field of /proc/self/status, MB.
double statusMb(const std::string& field) {
    std::ifstream status("/proc/self/status");
    for (std::string name; status >> name;) {
        double kb = 0;
        if (name == field + ":" && status >> kb) return kb * 1024 / 1e6;
    }
    return 0;
}

struct Way {
    std::string name;
    std::function<void()> read;
    std::vector<double> seconds{}, ratios{};
};

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Times ways to read an image, or to make its surface.");
    fs::path input;
    int repeats = 7;
    std::string only;
    std::optional<double> isovalue;
    app.add_option("INPUT", input, "An image file or a DICOM folder")->required();
    app.add_option("--iso", isovalue, "Make the surface: library, itkFilter, vtkFilter");
    app.add_option("--repeats", repeats, "Runs of each way (default: 7)");
    app.add_option("--only", only, "One run of the way of this name, with its memory");
    CLI11_PARSE(app, argc, argv);

    ReadOptions sandboxed, unsandboxed;
    unsandboxed.sandbox = false;
    const adaptiso::ReadVolume scan = adaptiso::readVolume(input, sandboxed);
    const adaptiso::VolumeView& view = scan.volume.view();
    const auto ours = [&](const ReadOptions& options) {
        adaptiso::valueRange(adaptiso::readVolume(input, options).volume);
    };
    std::vector<Way> ways;
    const auto addWays = [&]<class T>(T) {
        if (isovalue) {
            ways.push_back({"library", [&] {
                                adaptiso::ExtractionOptions options;
                                options.isovalue = *isovalue;
                                options.computeNormals = false;
                                adaptiso::extractSurface(view, options);
                            }});
            ways.push_back({"itkFilter", [&] { extractByItk<T>(view, *isovalue); }});
            ways.push_back({"vtkFilter", [&] { extractByVtk<T>(view, *isovalue); }});
            return;
        }
        ways.push_back({"unsandboxed", [&] { ours(unsandboxed); }});
        ways.push_back({"sandboxed", [&] { ours(sandboxed); }});
        ways.push_back({"plugged", [&] { readPlugged<T>(input); }});
        ways.push_back({"itk", [&] { readWithItk<T>(input); }});
    };
    if (view.pixelType() == adaptiso::PixelType::UInt8) {
        addWays(std::uint8_t{});
    } else if (view.pixelType() == adaptiso::PixelType::Float32) {
        addWays(float{});
    } else {
        addWays(std::int16_t{});
    }
    if (!only.empty()) {
        std::ofstream("/proc/self/clear_refs") << 5;  // forget the peak so far
        const double before = statusMb("VmRSS");
        for (Way& way : ways) {
            if (way.name == only) way.read();
        }
        std::cout << only << ": " << before << " MB before, peak " << statusMb("VmHWM") << " MB\n";
        return 0;
    }
    for (int n = 0; n < repeats; ++n) {
        for (Way& way : ways) {
            way.seconds.push_back(secondsOf(way.read));
            way.ratios.push_back(way.seconds.back() / ways.front().seconds.back());
        }
    }
    std::cout << "| way | seconds | x first |\n|---|---:|---:|\n";
    for (const Way& way : ways) {
        std::cout << "| " << way.name << " | " << median(way.seconds) << " | " << median(way.ratios)
                  << " |\n";
    }
}
