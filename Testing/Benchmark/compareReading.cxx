// Reads one image with this library, behind the fence and without it, and with ITK alone, in turn
// within one process. Testing/Benchmark/README.md explains the columns.
#include <itkGDCMImageIO.h>
#include <itkGDCMSeriesFileNames.h>
#include <itkImageFileReader.h>
#include <itkImageSeriesReader.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <numeric>
#include <string>
#include <vector>

#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/ItkAdaptor/ItkImageAdaptor.h"

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

double secondsOf(const std::function<void()>& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
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
    std::vector<double> seconds, ratios;
};

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Times reading an image behind the fence, without it, and with ITK alone.");
    fs::path input;
    int repeats = 7;
    std::string only;
    app.add_option("INPUT", input, "An image file or a DICOM folder")->required();
    app.add_option("--repeats", repeats, "Runs of each way (default: 7)");
    app.add_option("--only", only, "One run of fenced, unfenced or itk, with its memory");
    CLI11_PARSE(app, argc, argv);

    ReadOptions fenced, unfenced;
    unfenced.fence = false;
    const auto type = adaptiso::readVolume(input, fenced).volume.view().pixelType();
    const auto ours = [&](const ReadOptions& options) {
        adaptiso::valueRange(adaptiso::readVolume(input, options).volume);
    };
    std::vector<Way> ways{{"unfenced", [&] { ours(unfenced); }, {}, {}},
                          {"fenced", [&] { ours(fenced); }, {}, {}},
                          {"itk",
                           [&] {
                               if (type == adaptiso::PixelType::UInt8) {
                                   readWithItk<std::uint8_t>(input);
                               } else if (type == adaptiso::PixelType::Float32) {
                                   readWithItk<float>(input);
                               } else {
                                   readWithItk<std::int16_t>(input);
                               }
                           },
                           {},
                           {}}};
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
    std::cout << "| way | seconds | x unfenced |\n|---|---:|---:|\n";
    for (const Way& way : ways) {
        std::cout << "| " << way.name << " | " << median(way.seconds) << " | " << median(way.ratios)
                  << " |\n";
    }
}
