#include "Samples.h"

#include <fmt/core.h>

#include <cmath>
#include <new>

#include "FileFault.h"

namespace adaptiso::detail {
namespace {

/// Reads in pieces and scales on the way, so that the stored samples are never all in memory.
template <class Out, class Stored>
void readScaled(ByteSource& source, const SampleLayout& layout, std::int64_t count, Out* out) {
    std::vector<Stored> piece(std::size_t{1} << 17);
    for (std::int64_t done = 0; done < count;) {
        const auto n = std::min<std::int64_t>(count - done, std::ssize(piece));
        const auto byteCount = static_cast<std::uint64_t>(n) * sizeof(Stored);
        source.read(piece.data(), byteCount);
        if (layout.byteOrder != std::endian::native) {
            swapBytes(reinterpret_cast<std::byte*>(piece.data()), byteCount, sizeof(Stored));
        }
        for (std::int64_t i = 0; i < n; ++i) {
            out[done + i] =
                static_cast<Out>(layout.slope * static_cast<double>(piece[i]) + layout.intercept);
        }
        done += n;
    }
}

}  // namespace

std::uint64_t requireImageBytes(const std::filesystem::path& file, const Index3& size,
                                PixelType type) {
    constexpr std::uint64_t kLargest = std::uint64_t{1} << 60;
    std::uint64_t bytes = bytesPerPixel(type);
    for (const std::int64_t extent : size) {
        if (extent < 1) {
            refuse(file,
                   fmt::format("its header is damaged: image size {} x {} x {}", size[0], size[1],
                               size[2]),
                   "sizes must be at least 1");
        }
        if (static_cast<std::uint64_t>(extent) > kLargest / bytes) {
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
    try {
        return SampleBuffer(new std::byte[byteCount]);
    } catch (const std::bad_alloc&) {
        refuse(file, fmt::format("needs {} bytes of memory, more than there is", byteCount),
               "use a machine with more memory or crop the image");
    }
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

Volume readSamples(const std::filesystem::path& file, ByteSource& source,
                   const SampleLayout& layout, const ImageGeometry& geometry) {
    const std::uint64_t storedBytes = requireImageBytes(file, geometry.size, layout.stored);
    requireUsableGeometry(file, geometry);
    source.requireRoomFor(storedBytes);

    const PixelType type = layout.isScaled ? floatTypeFor(layout.stored) : layout.stored;
    const std::int64_t count = geometry.voxelCount();
    SampleBuffer samples =
        allocateSamples(file, static_cast<std::uint64_t>(count) * bytesPerPixel(type));
    if (!layout.isScaled) {
        source.read(samples.get(), storedBytes);
        if (layout.byteOrder != std::endian::native) {
            swapBytes(samples.get(), storedBytes, bytesPerPixel(layout.stored));
        }
    } else {
        withPixelType(layout.stored, [&]<class Stored>(Stored) {
            if (type == PixelType::Float32) {
                readScaled<float, Stored>(source, layout, count,
                                          reinterpret_cast<float*>(samples.get()));
            } else {
                readScaled<double, Stored>(source, layout, count,
                                           reinterpret_cast<double*>(samples.get()));
            }
        });
    }
    source.finish();
    return makeVolume(std::move(samples), type, geometry);
}

Volume makeVolume(SampleBuffer samples, PixelType type, const ImageGeometry& geometry) {
    const VolumeView view(samples.get(), type, geometry);
    return Volume(view, std::move(samples));
}

}  // namespace adaptiso::detail
