#include "RandomVolumes.h"

#include <ostream>
#include <string_view>

#include "Support/AnalyticVolumes.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso::testing {
namespace {

std::int64_t below(std::uint64_t& state, std::int64_t limit) {
    return static_cast<std::int64_t>(nextRandom(state) % static_cast<std::uint64_t>(limit));
}

}  // namespace

HardVolume hardVolume(std::uint64_t seed, int maximumSize) {
    std::uint64_t state = seed;
    ImageGeometry geometry;
    for (auto& extent : geometry.size) extent = 1 + below(state, maximumSize);
    const std::int64_t values = 2 + below(state, 4), kind = below(state, 3);
    const std::int64_t slope[3] = {below(state, 4), below(state, 4), 1 + below(state, 3)};
    std::vector<std::uint8_t> samples(static_cast<std::size_t>(geometry.voxelCount()));
    for (std::int64_t i = 0; i < geometry.voxelCount(); ++i) {
        const std::int64_t x = i % geometry.size[0], y = i / geometry.size[0] % geometry.size[1],
                           z = i / (geometry.size[0] * geometry.size[1]);
        std::int64_t value = below(state, values);  // noise
        if (kind == 1) {                            // stairs, one voxel in eight a step off
            value = (slope[0] * x + slope[1] * y + slope[2] * z) / 4 + (below(state, 8) == 0);
        } else if (kind == 2) {  // single voxels
            value = below(state, 10) == 0 ? values - 1 : 0;
        }
        samples[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(value % values);
    }
    // on the samples' values, or half-way between two
    const double isovalue = static_cast<double>(1 + below(state, values - 1)) -
                            0.5 * static_cast<double>(below(state, 2));
    return {Volume::fromSamples(std::move(samples), geometry), isovalue};
}

HardVolume binaryVolume(
    const Index3& size,
    const std::function<bool(std::int64_t, std::int64_t, std::int64_t)>& isInside) {
    ImageGeometry geometry;
    geometry.size = size;
    std::vector<std::uint8_t> samples;
    for (std::int64_t z = 0; z < size[2]; ++z) {
        for (std::int64_t y = 0; y < size[1]; ++y) {
            for (std::int64_t x = 0; x < size[0]; ++x) {
                samples.push_back(isInside(x, y, z) ? 100 : 0);
            }
        }
    }
    return {Volume::fromSamples(std::move(samples), geometry), 50};
}

std::ostream& operator<<(std::ostream& out, const MethodChoice& choice) {
    return out << toString(choice.method) << (choice.adjustVertices ? "Adjusted" : "")
               << (choice.mergeWithinBlocks ? "WithinBlocks" : "");
}

Extraction extractFrom(const VolumeView& volume, double isovalue, const MethodChoice& choice,
                       int blockSize, Border border) {
    ExtractionOptions options;
    options.isovalue = isovalue;
    options.method = choice.method;
    options.discretized.adjustVertices = choice.adjustVertices;
    options.discretized.mergeWithinBlocks = choice.mergeWithinBlocks;
    return extractSurface(volume, SpanSpaceIndex::build(volume, {blockSize, border}), options);
}

::testing::AssertionResult keepsItsPromises(const HardVolume& hard, const MethodChoice& choice,
                                            int blockSize, Border border) {
    const VolumeView& volume = hard.volume;
    SoundnessOptions soundness;
    if (border == Border::Open) soundness = openOnlyAtBorder(volume.geometry());
    const Extraction ours = extractFrom(volume, hard.isovalue, choice, blockSize, border);
    const Extraction full =
        extractFrom(volume, hard.isovalue, Method::MarchingCubes, blockSize, border);
    const std::string_view name = toString(choice.method);

    if (const auto sound = isSound(ours.mesh, soundness); !sound) {
        return ::testing::AssertionFailure() << name << ": " << sound.message();
    }
    if (const auto sound = isSound(full.mesh, soundness); !sound) {
        return ::testing::AssertionFailure() << "mc: " << sound.message();
    }
    const std::int64_t changed = ours.statistics.boxesChangingTopology;
    if (choice.method == Method::DiscretizedMarchingCubes && changed != 0) {
        return ::testing::AssertionFailure() << changed << " unit boxes change the topology";
    }
    const TopologyReport oursTopology = checkTopology(ours.mesh),
                         fullTopology = checkTopology(full.mesh);
    const bool isSame = oursTopology.components.size() == fullTopology.components.size() &&
                        oursTopology.eulerCharacteristic() == fullTopology.eulerCharacteristic();
    if (!isSame && changed == 0) {
        return ::testing::AssertionFailure()
               << name << ": topology differs from mc and no box says why: "
               << oursTopology.components.size() << " components of Euler characteristic "
               << oursTopology.eulerCharacteristic() << " against "
               << fullTopology.components.size() << " of " << fullTopology.eulerCharacteristic();
    }
    if (ours.statistics.marchingCubesTriangles != full.statistics.marchingCubesTriangles) {
        return ::testing::AssertionFailure()
               << name << " counts " << ours.statistics.marchingCubesTriangles
               << " triangles of marching cubes, mc " << full.statistics.marchingCubesTriangles;
    }
    return ::testing::AssertionSuccess();
}

}  // namespace adaptiso::testing
