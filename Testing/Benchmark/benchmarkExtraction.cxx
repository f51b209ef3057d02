// The steps of an extraction by themselves, on 128^3 samples made in memory: a gyroid, whose
// surface is everywhere, and a sphere, whose surface meets few blocks.
//
//   benchmarkExtraction [--benchmark_filter=REGEX] [--benchmark_format=json] ...
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "adaptiso/Core/Volume.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"

namespace {

using namespace adaptiso;

constexpr std::int64_t kSize = 128;
constexpr double kIsovalue = 1000.5;  // off the integer samples

/// int16 samples 1000 + 500 * field(x, y, z), coordinates in [-1, 1], 1 mm voxels.
template <class Field>
Volume sampled(const Field& field) {
    ImageGeometry geometry;
    geometry.size = {kSize, kSize, kSize};
    const auto coordinate = [](std::int64_t i) {
        return 2.0 * static_cast<double>(i) / (kSize - 1) - 1;
    };
    std::vector<std::int16_t> samples;
    samples.reserve(static_cast<std::size_t>(geometry.voxelCount()));
    for (std::int64_t k = 0; k < kSize; ++k) {
        for (std::int64_t j = 0; j < kSize; ++j) {
            for (std::int64_t i = 0; i < kSize; ++i) {
                const double value =
                    1000 + 500 * field(coordinate(i), coordinate(j), coordinate(k));
                samples.push_back(static_cast<std::int16_t>(std::lround(value)));
            }
        }
    }
    return Volume::fromSamples(std::move(samples), geometry);
}

/// Four periods along every axis.
double gyroidField(double x, double y, double z) {
    constexpr double kTurn = 4 * std::numbers::pi;
    return std::sin(kTurn * x) * std::cos(kTurn * y) + std::sin(kTurn * y) * std::cos(kTurn * z) +
           std::sin(kTurn * z) * std::cos(kTurn * x);
}

double sphereField(double x, double y, double z) {
    return 0.8 - std::sqrt(x * x + y * y + z * z);
}

const Volume& gyroid() {
    static const Volume kVolume = sampled(gyroidField);
    return kVolume;
}

const Volume& sphere() {
    static const Volume kVolume = sampled(sphereField);
    return kVolume;
}

using MakeVolume = const Volume& (*)();

SpanSpaceIndex buildIndex(const Volume& volume, int blockSize) {
    IndexOptions options;
    options.blockSize = blockSize;
    return SpanSpaceIndex::build(volume, options);
}

void buildsIndex(benchmark::State& state, MakeVolume volume) {
    const auto blockSize = static_cast<int>(state.range(0));
    for (auto _ : state) benchmark::DoNotOptimize(buildIndex(volume(), blockSize));
    const SpanSpaceIndex index = buildIndex(volume(), blockSize);
    state.counters["blocks"] = static_cast<double>(index.grid().blockCount());
    state.counters["indexBytes"] = static_cast<double>(index.memoryBytes());
    state.SetBytesProcessed(state.iterations() *
                            static_cast<std::int64_t>(volume().view().byteCount()));
}

void asksIndex(benchmark::State& state, MakeVolume volume) {
    const SpanSpaceIndex index = buildIndex(volume(), static_cast<int>(state.range(0)));
    for (auto _ : state) benchmark::DoNotOptimize(index.blocksAt(kIsovalue));
    const BlockQuery query = index.blocksAt(kIsovalue);
    state.counters["blocks"] = static_cast<double>(query.blocks.size());
    state.counters["nodesVisited"] = static_cast<double>(query.nodesVisited);
}

void extracts(benchmark::State& state, MakeVolume volume, Method method) {
    const SpanSpaceIndex index = buildIndex(volume(), static_cast<int>(state.range(0)));
    ExtractionOptions options;
    options.isovalue = kIsovalue;
    options.method = method;
    std::int64_t triangles = 0;
    for (auto _ : state) {
        Extraction extraction = extractSurface(volume(), index, options);
        triangles = static_cast<std::int64_t>(extraction.mesh.triangles.size());
        benchmark::DoNotOptimize(extraction.mesh.points.data());
    }
    state.counters["triangles"] = static_cast<double>(triangles);
    state.SetItemsProcessed(state.iterations() * triangles);
}

template <class Function, class... Arguments>
void declare(const std::string& name, Function function, Arguments... arguments) {
    auto* const entry = benchmark::RegisterBenchmark(name.c_str(), function, arguments...);
    entry->ArgName("block")->RangeMultiplier(2)->Range(2, 16)->UseRealTime();
    entry->Unit(benchmark::kMillisecond);
}

const bool kAreDeclared = [] {
    const std::pair<std::string, MakeVolume> volumes[] = {{"gyroid", gyroid}, {"sphere", sphere}};
    for (const auto& [name, volume] : volumes) {
        declare("index/" + name, buildsIndex, volume);
        declare("query/" + name, asksIndex, volume);
        declare("mc/" + name, extracts, volume, Method::MarchingCubes);
        declare("dmc/" + name, extracts, volume, Method::DiscretizedMarchingCubes);
        declare("asc/" + name, extracts, volume, Method::SkeletonClimbing);
        declare("boxes/" + name, extracts, volume, Method::Boxes);
    }
    return true;
}();

}  // namespace
