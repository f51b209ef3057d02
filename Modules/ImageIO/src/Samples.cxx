#include "Samples.h"

#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <new>

#include "FileFault.h"
#include "Sandbox.h"

namespace adaptiso::detail {
namespace {

constexpr std::uint64_t kLargestFile = std::uint64_t{1} << 60;  // bytes

/// Reads in pieces, picks and scales on the way, so that what is stored is never all in memory.
/// \return samples that were finite and are no more
template <class Out, class Stored>
std::int64_t readConverted(ByteSource& source, const SampleLayout& layout, std::int64_t count,
                           Out* out) {
    std::int64_t overflows = 0;
    const std::int64_t stride = layout.isInterleaved ? layout.volumeCount : 1;
    const std::int64_t first = layout.isInterleaved ? layout.volume : 0;
    constexpr std::int64_t kPieceSamples = 1 << 17;
    const std::int64_t pieceVoxels = std::max<std::int64_t>(1, kPieceSamples / stride);
    std::vector<Stored> piece(static_cast<std::size_t>(std::min(pieceVoxels, count) * stride));
    for (std::int64_t done = 0; done < count;) {
        const auto n = std::min(count - done, pieceVoxels);
        const auto byteCount = static_cast<std::uint64_t>(n * stride) * sizeof(Stored);
        source.read(piece.data(), byteCount);
        if (layout.byteOrder != std::endian::native) {
            swapBytes(reinterpret_cast<std::byte*>(piece.data()), byteCount, sizeof(Stored));
        }
        for (std::int64_t i = 0; i < n; ++i) {
            const Stored stored = piece[static_cast<std::size_t>(i * stride + first)];
            if (!layout.isScaled) {
                out[done + i] = static_cast<Out>(stored);
                continue;
            }
            const auto value = static_cast<double>(stored);
            out[done + i] = scaledSample<Out>(value, layout.slope, layout.intercept);
            overflows += std::isfinite(value) && !std::isfinite(out[done + i]);
        }
        done += n;
    }
    return overflows;
}

/// \return as readConverted()
std::int64_t readInto(std::byte* samples, PixelType type, ByteSource& source,
                      const SampleLayout& layout, std::int64_t count) {
    if (!layout.isScaled && !layout.isInterleaved) {
        const std::uint64_t byteCount = static_cast<std::uint64_t>(count) * bytesPerPixel(type);
        source.read(samples, byteCount);
        if (layout.byteOrder != std::endian::native) {
            swapBytes(samples, byteCount, bytesPerPixel(type));
        }
        return 0;
    }
    return withPixelType(layout.stored, [&]<class Stored>(Stored) {
        if (!layout.isScaled) {
            return readConverted<Stored, Stored>(source, layout, count,
                                                 reinterpret_cast<Stored*>(samples));
        }
        if (type == PixelType::Float32) {
            return readConverted<float, Stored>(source, layout, count,
                                                reinterpret_cast<float*>(samples));
        }
        return readConverted<double, Stored>(source, layout, count,
                                             reinterpret_cast<double*>(samples));
    });
}

}  // namespace

std::string SampleLayout::scalingText(const char* slopeName, const char* interceptName) const {
    if (!isScaled) return {};
    return fmt::format("{} {}, {} {}", slopeName, number(slope), interceptName, number(intercept));
}

std::uint64_t requireProduct(const std::filesystem::path& file, std::uint64_t a, std::uint64_t b) {
    if (a > 0 && b > kLargestFile / a) {
        refuse(file,
               "its header asks for more memory than any machine has (its size and number of "
               "volumes)",
               "the file is damaged");
    }
    return a * b;
}

std::uint64_t requireImageBytes(const std::filesystem::path& file, const Index3& size,
                                PixelType type) {
    std::uint64_t bytes = bytesPerPixel(type);
    for (const std::int64_t extent : size) {
        if (extent < 1) {
            refuse(file,
                   fmt::format("its header is damaged: image size {} x {} x {}", size[0], size[1],
                               size[2]),
                   "sizes must be at least 1");
        }
        if (static_cast<std::uint64_t>(extent) > kLargestFile / bytes) {
            refuse(file,
                   fmt::format("its header asks for more memory than any machine has (image "
                               "size {} x {} x {})",
                               size[0], size[1], size[2]),
                   "the file is damaged");
        }
        bytes *= static_cast<std::uint64_t>(extent);
    }
    for (const std::int64_t extent : size) {
        if (extent == 1) {
            refuse(file,
                   fmt::format("is a 2-D image or a single slice (size {} x {} x {})", size[0],
                               size[1], size[2]),
                   "a surface needs a volume of at least 2 slices");
        }
    }
    return bytes;
}

SampleBuffer allocateSamples(const std::filesystem::path& file, std::uint64_t byteCount) {
    SampleBuffer samples;
    if (byteCount > std::numeric_limits<std::size_t>::max()) {
        refuseShort(
            file,
            fmt::format("its samples take {:.1f} GB of memory, and a build of 32 bits, such as "
                        "WebAssembly, has 4 GB",
                        static_cast<double>(byteCount) / 1e9),
            "use the programs of a 64-bit machine");
    }
    if (isInSandbox()) {
        samples = allocateSharedBytes(byteCount);
    } else {
        samples.reset(new (std::nothrow) std::byte[byteCount]);
    }
    if (!samples) {
        refuseShort(file, fmt::format("needs {} bytes of memory, more than there is", byteCount),
                    "use a machine with more memory, or adaptiso-giant, which works tile by tile");
    }
    return samples;
}

void requireUsableGeometry(const std::filesystem::path& file, const ImageGeometry& geometry) {
    const auto& axes = geometry.indexToPhysical.column;
    for (int axis = 0; axis < 3; ++axis) {
        const double step = norm(axes[axis]);
        if (!std::isfinite(step) || !std::isfinite(geometry.originMm[axis])) {
            refuse(file,
                   "its orientation, spacing or origin is not finite (NaN or infinity in the "
                   "direction matrix)",
                   "repair the header");
        }
        if (std::abs(geometry.originMm[axis]) > 1e9) {
            refuse(file,
                   fmt::format("implausible origin {} mm along {}", number(geometry.originMm[axis]),
                               "xyz"[axis]),
                   "repair the header's origin");
        }
        if (!(step >= 1e-6 && step <= 1e6)) {
            refuse(file,
                   fmt::format("implausible voxel spacing {} mm along axis {}", number(step),
                               "xyz"[axis]),
                   "repair the header's spacing");
        }
    }
    const double flatness = std::abs(determinant(geometry.indexToPhysical)) /
                            (norm(axes[0]) * norm(axes[1]) * norm(axes[2]));
    if (!(flatness > 1e-4)) {
        refuse(file, "its direction matrix is singular: the axes span no volume",
               "repair the header's affine");
    }
}

void swapBytes(std::byte* samples, std::uint64_t byteCount, std::size_t bytesPerSample) {
    if (bytesPerSample == 1) return;
    for (std::byte* sample = samples; sample != samples + byteCount; sample += bytesPerSample) {
        std::reverse(sample, sample + bytesPerSample);
    }
}

std::int64_t chooseVolume(const std::filesystem::path& file, std::int64_t count,
                          const ReadOptions& options, const std::string& several) {
    const std::optional<std::int64_t> chosen = options.volumeIndex;
    if (chosen ? *chosen >= 0 && *chosen < count : count == 1) return chosen.value_or(0);
    const std::string fault =
        chosen            ? fmt::format("there is no volume {}: it holds {}", *chosen, count)
        : several.empty() ? fmt::format("is 4-D: it holds {} volumes", count)
                          : several;
    if (count == 1) refuse(file, fault, "leave --volume-index out");
    refuseChoice(file, fault, fmt::format("choose one: --volume-index 0 to {}", count - 1),
                 ChoiceNeeded::Among::Volumes, count);
}

Volume readSamples(const std::filesystem::path& file, ByteSource& source,
                   const SampleLayout& layout, const ImageGeometry& geometry) {
    const std::uint64_t volumeBytes = requireImageBytes(file, geometry.size, layout.stored);
    requireUsableGeometry(file, geometry);
    const auto volumes = static_cast<std::uint64_t>(layout.volumeCount);
    source.requireRoomFor(requireProduct(file, volumes, volumeBytes));
    const auto volumesBefore = static_cast<std::uint64_t>(layout.volume);
    if (!layout.isInterleaved) source.skip(volumesBefore * volumeBytes);

    const PixelType type = layout.isScaled ? floatTypeFor(layout.stored) : layout.stored;
    const std::int64_t count = geometry.voxelCount();
    SampleBuffer samples =
        allocateSamples(file, static_cast<std::uint64_t>(count) * bytesPerPixel(type));
    const std::int64_t overflows = readInto(samples.get(), type, source, layout, count);
    if (overflows > 0) {
        refuse(
            file,
            fmt::format("its scaling (slope {}, intercept {}) makes {} of its {} voxels infinite",
                        number(layout.slope), number(layout.intercept), overflows, count),
            "repair the header");
    }
    if (!layout.isInterleaved) source.skip((volumes - 1 - volumesBefore) * volumeBytes);
    return makeVolume(std::move(samples), type, geometry);
}

Volume makeVolume(SampleBuffer samples, PixelType type, const ImageGeometry& geometry) {
    const VolumeView view(samples.get(), type, geometry);
    return Volume(view, std::move(samples));
}

}  // namespace adaptiso::detail
