// The volumes that the other programs read: a part of a scan, or a gyroid made in memory.
//
//   peerVolume scan IMAGE [--low I J K --high I J K] -o FILE
//   peerVolume gyroid SIDE [--periods P] -o FILE
#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "../Crop.h"
#include "../RunBenchmark.h"
#include "PeerFiles.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::benchmarks {
namespace {

/// int16 samples 10000 * gyroid, `periods` along each axis: smooth, and whole numbers move its
/// surface at 0.5 by less than a hundredth of a voxel even at 1024 samples a side.
Volume gyroid(std::int64_t side, double periods) {
    ImageGeometry geometry;
    geometry.size = {side, side, side};
    std::vector<double> sine(side), cosine(side);
    for (std::int64_t i = 0; i < side; ++i) {
        const double turn =
            2 * std::numbers::pi * periods * static_cast<double>(i) / static_cast<double>(side);
        sine[i] = std::sin(turn);
        cosine[i] = std::cos(turn);
    }
    std::vector<std::int16_t> samples(static_cast<std::size_t>(geometry.voxelCount()));
    parallelForPieces(side, 1, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t k = begin; k < end; ++k) {
            std::int16_t* out = samples.data() + k * side * side;
            for (std::int64_t j = 0; j < side; ++j) {
                for (std::int64_t i = 0; i < side; ++i) {
                    *out++ = static_cast<std::int16_t>(std::lround(
                        10000 * (sine[i] * cosine[j] + sine[j] * cosine[k] + sine[k] * cosine[i])));
                }
            }
        }
    });
    return Volume::fromSamples(std::move(samples), geometry);
}

/// Cells between the samples that have a sample on each side of the isovalue.
std::int64_t activeCells(const VolumeView& volume, double isovalue) {
    std::atomic<std::int64_t> count{0};
    dispatchPixelType(volume, [&](const auto& v) {
        const Index3& n = v.geometry.size;
        parallelForPieces(n[2] - 1, 1, [&](std::int64_t begin, std::int64_t end) {
            std::int64_t found = 0;
            for (std::int64_t k = begin; k < end; ++k) {
                for (std::int64_t j = 0; j + 1 < n[1]; ++j) {
                    for (std::int64_t i = 0; i + 1 < n[0]; ++i) {
                        int inside = 0;
                        for (int c = 0; c < 8; ++c) {
                            const auto s = v.at(i + c % 2, j + c / 2 % 2, k + c / 4);
                            inside += static_cast<double>(s) >= isovalue ? 1 : 0;
                        }
                        found += inside % 8 != 0 ? 1 : 0;
                    }
                }
            }
            count += found;
        });
    });
    return count;
}

struct Arguments {
    std::string output;
    std::optional<double> isovalue;
    std::optional<std::string> image;  ///< none: a gyroid is made
    std::optional<Index3> low, high;   ///< none: the whole image
    std::int64_t side = 0;
    double periods = 4;
};

void declareOptions(CLI::App& app, Arguments& arguments) {
    app.require_subcommand(1);
    app.fallthrough();  // -o may stand behind the subcommand
    app.add_option("-o,--output", arguments.output, "FILE")->required();
    app.add_option("--iso", arguments.isovalue, "Count the cells that this isovalue cuts");
    CLI::App* scan = app.add_subcommand("scan", "A scan, or the part of it from --low to --high");
    scan->add_option("image", arguments.image, "As adaptiso-mesh takes it")->required();
    CLI::Option* low = scan->add_option("--low", arguments.low, "First voxel");
    CLI::Option* high = scan->add_option("--high", arguments.high, "Last voxel");
    low->needs(high);
    high->needs(low);
    CLI::App* made = app.add_subcommand("gyroid", "A gyroid of int16 samples; isovalue 0.5");
    made->add_option("side", arguments.side, "Samples a side")
        ->required()
        ->check(CLI::Range(8, 4096));
    made->add_option("--periods", arguments.periods, "Along each axis (default 4)");
}

void run(const Arguments& arguments) {
    const Volume volume = [&] {
        if (!arguments.image) return gyroid(arguments.side, arguments.periods);
        Volume whole = readVolume(*arguments.image).volume;
        if (!arguments.low) return whole;
        return cropped(whole, {*arguments.low, *arguments.high});
    }();
    writeVolumeFile(arguments.output, volume);
    nlohmann::ordered_json report{{"size", volume.view().geometry().size},
                                  {"pixelType", toString(volume.view().pixelType())},
                                  {"bytes", volume.view().byteCount()}};
    if (arguments.isovalue) report["activeCells"] = activeCells(volume, *arguments.isovalue);
    std::cout << report.dump() << '\n';
}

}  // namespace
}  // namespace adaptiso::benchmarks

int main(int argc, char** argv) {
    using namespace adaptiso::benchmarks;
    CLI::App app("Makes volumes for the benchmark of peers", "peerVolume");
    Arguments arguments;
    declareOptions(app, arguments);
    return runBenchmark(app, argc, argv, [&] { run(arguments); });
}
