#include "RandomVolumes.h"

#include "Support/AnalyticVolumes.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso::testing {
namespace {

std::int64_t below(std::uint64_t& state, std::int64_t limit) {
    return static_cast<std::int64_t>(nextRandom(state) % static_cast<std::uint64_t>(limit));
}

std::int64_t eulerCharacteristic(const TopologyReport& report) {
    std::int64_t sum = 0;
    for (const SurfaceComponent& c : report.components) sum += c.eulerCharacteristic();
    return sum;
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

Extraction extractFrom(const VolumeView& volume, double isovalue, Method method, int blockSize,
                       Border border) {
    ExtractionOptions options;
    options.isovalue = isovalue;
    options.method = method;
    return extractSurface(volume, SpanSpaceIndex::build(volume, {blockSize, border}), options);
}

::testing::AssertionResult keepsItsPromises(const HardVolume& hard, int blockSize, Border border) {
    const VolumeView& volume = hard.volume;
    SoundnessOptions soundness;
    if (border == Border::Open) soundness = openOnlyAtBorder(volume.geometry());
    const Extraction boxes = extractFrom(volume, hard.isovalue, Method::Boxes, blockSize, border);
    const Extraction cubes =
        extractFrom(volume, hard.isovalue, Method::MarchingCubes, blockSize, border);

    if (const auto sound = isSound(boxes.mesh, soundness); !sound) {
        return ::testing::AssertionFailure() << "boxes: " << sound.message();
    }
    if (const auto sound = isSound(cubes.mesh, soundness); !sound) {
        return ::testing::AssertionFailure() << "mc: " << sound.message();
    }
    const TopologyReport ours = checkTopology(boxes.mesh), full = checkTopology(cubes.mesh);
    const bool isSame = ours.components.size() == full.components.size() &&
                        eulerCharacteristic(ours) == eulerCharacteristic(full);
    if (!isSame && boxes.statistics.boxesChangingTopology == 0) {
        return ::testing::AssertionFailure()
               << "topology differs from mc and no box says why: " << ours.components.size()
               << " components of Euler characteristic " << eulerCharacteristic(ours) << " against "
               << full.components.size() << " of " << eulerCharacteristic(full);
    }
    if (boxes.statistics.marchingCubesTriangles != cubes.statistics.marchingCubesTriangles) {
        return ::testing::AssertionFailure()
               << "boxes count " << boxes.statistics.marchingCubesTriangles
               << " triangles of marching cubes, mc " << cubes.statistics.marchingCubesTriangles;
    }
    return ::testing::AssertionSuccess();
}

}  // namespace adaptiso::testing
