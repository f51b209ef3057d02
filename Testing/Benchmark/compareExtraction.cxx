// compareExtraction VOLUME --iso V: this library and vtkFlyingEdges3D on one scan, side by side.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <string>

#include "Comparison.h"
#include "ComparisonReport.h"
#include "Crop.h"
#include "RunBenchmark.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::benchmarks {
namespace {

struct Arguments {
    std::string volume;
    std::string json;
    std::string commit;
    std::string crop;
    ComparisonOptions options;
};

void declareOptions(CLI::App& app, Arguments& arguments) {
    app.add_option("volume", arguments.volume, "A scan, as adaptiso-mesh takes it")->required();
    app.add_option("--iso", arguments.options.isovalue, "Isovalue of the surface")
        ->type_name("V")
        ->check(CLI::Number)
        ->required();
    app.add_option("--json", arguments.json, "Write the numbers to FILE")->type_name("FILE");
    app.add_option("--repeats", arguments.options.repeats, "Timed runs of each (default 5)")
        ->type_name("N")
        ->check(CLI::Range(1, 1000));
    app.add_option("--threads", arguments.options.threads, "Threads of each side (default 2)")
        ->type_name("N")
        ->check(CLI::Range(1, 1024));
    app.add_option("--commit", arguments.commit, "What the JSON says was measured")
        ->type_name("TEXT");
    app.add_option("--crop", arguments.crop, "Of the scan, samples i0 to i1, ... alone")
        ->type_name("i0:i1,j0:j1,k0:k1");
    app.add_option("--block-sizes", arguments.options.blockSizes, "Default 2,4,8,16")
        ->type_name("N,...")
        ->delimiter(',')
        ->check(CLI::IsMember({2, 4, 8, 16}));
    app.add_option("--borders", arguments.options.borders, "Default open,closed")
        ->type_name("B,...")
        ->delimiter(',')
        ->transform(CLI::CheckedTransformer(
            std::map<std::string, Border>{{"open", Border::Open}, {"closed", Border::Closed}}));
}

void writeJsonFile(const std::string& path, const Comparison& comparison,
                   const ComparisonContext& context) {
    std::ofstream file(path);
    writeJson(file, comparison, context);
    file.close();
    if (!file) throw FileError(path + ": can't be written");
}

void run(const Arguments& arguments) {
    const ReadVolume input = readVolume(arguments.volume);
    const Volume part =
        arguments.crop.empty() ? input.volume : cropped(input.volume, parseCrop(arguments.crop));
    const VolumeView& volume = part;
    const Comparison comparison = compareExtractions(volume, arguments.options);
    const ComparisonContext context{arguments.volume,  arguments.commit,   arguments.crop,
                                    arguments.options, volume.pixelType(), volume.geometry()};
    writeMarkdown(std::cout, comparison, context);
    if (!arguments.json.empty()) writeJsonFile(arguments.json, comparison, context);
}

}  // namespace
}  // namespace adaptiso::benchmarks

int main(int argc, char** argv) {
    using namespace adaptiso::benchmarks;
    CLI::App app("Compares this library's isosurfaces with vtkFlyingEdges3D's",
                 "compareExtraction");
    Arguments arguments;
    declareOptions(app, arguments);
    return runBenchmark(app, argc, argv, [&] { run(arguments); });
}
