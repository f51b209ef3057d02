// The volumes that the other programs read: a part of a scan, or a gyroid made in memory.
//
//   peerVolume scan IMAGE [--low I J K --high I J K] -o FILE
//   peerVolume gyroid SIDE [--periods P] -o FILE
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <exception>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "PeerFiles.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::benchmarks {
namespace {

using Place = std::array<std::int64_t, 3>;

Volume cropped(const VolumeView& volume, const Place& low, const Place& high) {
    ImageGeometry geometry = volume.geometry();
    for (int a = 0; a < 3; ++a) {
        if (low[a] < 0 || high[a] < low[a] || high[a] >= volume.geometry().size[a]) {
            throw InvalidInput("peerVolume: --low and --high must lie in the image, low first");
        }
        geometry.size[a] = high[a] - low[a] + 1;
    }
    geometry.originMm = volume.geometry().toPhysical(
        {static_cast<double>(low[0]), static_cast<double>(low[1]), static_cast<double>(low[2])});
    return dispatchPixelType(volume, [&](const auto& typed) {
        std::vector<std::remove_cvref_t<decltype(typed.samples[0])>> samples;
        samples.reserve(static_cast<std::size_t>(geometry.voxelCount()));
        for (std::int64_t k = low[2]; k <= high[2]; ++k) {
            for (std::int64_t j = low[1]; j <= high[1]; ++j) {
                const auto* row = &typed.at(low[0], j, k);
                samples.insert(samples.end(), row, row + geometry.size[0]);
            }
        }
        return Volume::fromSamples(std::move(samples), geometry);
    });
}

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

int run(int argc, char** argv) {
    CLI::App app("Makes volumes for the benchmark of peers");
    app.require_subcommand(1);
    app.fallthrough();  // -o may stand behind the subcommand
    std::string output, image;
    Place low{}, high{};
    std::int64_t side = 0;
    double periods = 4;
    std::optional<double> isovalue;
    app.add_option("-o,--output", output, "FILE")->required();
    app.add_option("--iso", isovalue, "Count the cells that this isovalue cuts");
    CLI::App* scan = app.add_subcommand("scan", "A scan, or the part of it from --low to --high");
    scan->add_option("image", image, "As adaptiso-mesh takes it")->required();
    CLI::Option* from = scan->add_option("--low", low, "First voxel");
    CLI::Option* to = scan->add_option("--high", high, "Last voxel");
    from->needs(to);
    to->needs(from);
    CLI::App* made = app.add_subcommand("gyroid", "A gyroid of int16 samples; isovalue 0.5");
    made->add_option("side", side, "Samples a side")->required()->check(CLI::Range(8, 4096));
    made->add_option("--periods", periods, "Along each axis (default 4)");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    const Volume volume = [&] {
        if (*made) return gyroid(side, periods);
        Volume whole = readVolume(image).volume;
        return to->count() > 0 ? cropped(whole, low, high) : whole;
    }();
    writeVolumeFile(output, volume);
    nlohmann::ordered_json report{{"size", volume.view().geometry().size},
                                  {"pixelType", toString(volume.view().pixelType())},
                                  {"bytes", volume.view().byteCount()}};
    if (isovalue) report["activeCells"] = activeCells(volume, *isovalue);
    std::cout << report.dump() << '\n';
    return 0;
}

}  // namespace
}  // namespace adaptiso::benchmarks

int main(int argc, char** argv) {
    try {
        return adaptiso::benchmarks::run(argc, argv);
    } catch (const adaptiso::Error& error) {
        std::cerr << "peerVolume: " << error.what() << '\n';
        return 3;
    } catch (const std::exception& error) {
        std::cerr << "peerVolume: " << error.what() << '\n';
        return 4;
    }
}
