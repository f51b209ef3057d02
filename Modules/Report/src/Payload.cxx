#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "PageParts.h"
#include "Slices.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso {
namespace {

static_assert(std::endian::native == std::endian::little, "NIfTI and MZ3 are written as in memory");

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
}

template <class T>
void append(std::string& bytes, T value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// \param geometry  LPS, of the samples
std::string nifti(const ImageGeometry& geometry, const std::vector<std::uint8_t>& samples) {
    std::string bytes(352, '\0');
    put<std::int32_t>(bytes, 0, 348);
    put<std::int16_t>(bytes, 40, 3);
    const Vec3 spacing = geometry.spacingMm();
    for (int axis = 0; axis < 3; ++axis) {
        put<std::int16_t>(bytes, 42 + 2 * axis, static_cast<std::int16_t>(geometry.size[axis]));
        put<float>(bytes, 80 + 4 * axis, static_cast<float>(spacing[axis]));
    }
    for (int n = 4; n < 8; ++n) put<std::int16_t>(bytes, 40 + 2 * n, 1);
    put<std::int16_t>(bytes, 70, 2);  // unsigned bytes
    put<std::int16_t>(bytes, 72, 8);
    put<float>(bytes, 76, 1);          // right-handed
    put<float>(bytes, 108, 352);       // where the samples begin
    put<float>(bytes, 112, 1);         // slope
    put<float>(bytes, 124, 255);       // white
    bytes[123] = 2;                    // mm
    put<std::int16_t>(bytes, 254, 1);  // the rows below say where the image lies
    for (int row = 0; row < 3; ++row) {
        const double sign = row == 2 ? 1 : -1;  // LPS -> RAS
        for (int axis = 0; axis < 3; ++axis) {
            put<float>(bytes, 280 + 16 * row + 4 * axis,
                       static_cast<float>(sign * geometry.indexToPhysical.column[axis][row]));
        }
        put<float>(bytes, 280 + 16 * row + 12, static_cast<float>(sign * geometry.originMm[row]));
    }
    std::memcpy(bytes.data() + 344, "n+1", 4);
    bytes.append(reinterpret_cast<const char*>(samples.data()), samples.size());
    return bytes;
}

/// Samples of the image that become one, along each axis, as cubic as possible.
Index3 blockSize(const ImageGeometry& image, std::int64_t maxVoxels) {
    constexpr std::int64_t kLongest = 32767;  // of a NIfTI-1 file
    Index3 block{1, 1, 1};
    const Vec3 spacing = image.spacingMm();
    const auto count = [&](int axis) { return (image.size[axis] - 1) / block[axis] + 1; };
    while (count(0) * count(1) * count(2) > maxVoxels ||
           std::max({count(0), count(1), count(2)}) > kLongest) {
        int finest = -1;
        for (int axis = 0; axis < 3; ++axis) {
            if (count(axis) == 1) continue;
            if (finest < 0 || spacing[axis] * static_cast<double>(block[axis]) <
                                  spacing[finest] * static_cast<double>(block[finest])) {
                finest = axis;
            }
        }
        if (finest < 0) break;
        ++block[finest];
    }
    return block;
}

ImageGeometry blockGeometry(const ImageGeometry& image, const Index3& block) {
    ImageGeometry geometry = image;
    Vec3 first;
    for (int axis = 0; axis < 3; ++axis) {
        geometry.size[axis] = (image.size[axis] - 1) / block[axis] + 1;
        geometry.indexToPhysical.column[axis] =
            static_cast<double>(block[axis]) * image.indexToPhysical.column[axis];
        first[axis] = static_cast<double>(block[axis] - 1) / 2;
    }
    geometry.originMm = image.toPhysical(first);
    return geometry;
}

/// The mean of the finite samples of a block; NaN without any.
template <class T>
double blockMean(const TypedVolumeView<T>& view, const Index3& first, const Index3& block) {
    double sum = 0;
    int found = 0;
    Index3 end;
    for (int axis = 0; axis < 3; ++axis) {
        end[axis] = std::min(first[axis] + block[axis], view.geometry.size[axis]);
    }
    for (std::int64_t k = first[2]; k < end[2]; ++k) {
        for (std::int64_t j = first[1]; j < end[1]; ++j) {
            for (std::int64_t i = first[0]; i < end[0]; ++i) {
                const auto value = static_cast<double>(view.at(i, j, k));
                if (!std::isfinite(value)) continue;
                sum += value;
                ++found;
            }
        }
    }
    return sum / found;
}

}  // namespace

std::string gzip(std::string_view bytes) {
    z_stream stream{};
    constexpr int kGzip = 16 + MAX_WBITS;
    if (deflateInit2(&stream, 6, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
        throw InternalError("gzip: zlib can't be started");
    }
    std::string packed;
    std::array<char, 1 << 16> buffer;
    int code = Z_OK;
    std::size_t taken = 0;
    while (code != Z_STREAM_END) {
        if (stream.avail_in == 0) {
            constexpr std::size_t kPiece = 1 << 24;
            const std::size_t count = std::min(kPiece, bytes.size() - taken);
            stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + taken));
            stream.avail_in = static_cast<uInt>(count);
            taken += count;
        }
        stream.next_out = reinterpret_cast<Bytef*>(buffer.data());
        stream.avail_out = static_cast<uInt>(buffer.size());
        code = deflate(&stream, taken == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
        packed.append(buffer.data(), buffer.size() - stream.avail_out);
    }
    deflateEnd(&stream);
    return packed;
}

std::string niftiOf(const VolumeView& volume, std::int64_t maxVoxels, const FaceCut* face) {
    const Index3 block = blockSize(volume.geometry(), maxVoxels);
    const ImageGeometry geometry = blockGeometry(volume.geometry(), block);
    const ValueRange window = greyWindow(volume);
    std::vector<std::uint8_t> samples(static_cast<std::size_t>(geometry.voxelCount()));
    const std::int64_t layer = geometry.size[0] * geometry.size[1];
    dispatchPixelType(volume, [&](const auto& view) {
        parallelForPieces(geometry.voxelCount(), layer, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t n = begin; n < end; ++n) {
                const Index3 first{n % geometry.size[0] * block[0],
                                   n % layer / geometry.size[0] * block[1], n / layer * block[2]};
                const Vec3 index{double(n % geometry.size[0]), double(n % layer / geometry.size[0]),
                                 double(n / layer)};
                if (face && face->hides(lpsToRas(geometry.toPhysical(index)))) continue;
                samples[static_cast<std::size_t>(n)] =
                    greyOf(blockMean(view, first, block), window);
            }
        });
    });
    return nifti(geometry, samples);
}

std::string blankNifti(const BoundingBox& box) {
    constexpr std::int64_t kSide = 16;
    ImageGeometry geometry;
    geometry.size = {kSide, kSide, kSide};
    const Vec3 extent = box.size();
    const double longest = std::max({extent.x, extent.y, extent.z, 1e-6});
    Vec3 step;
    for (int axis = 0; axis < 3; ++axis) step[axis] = (extent[axis] + 0.1 * longest) / (kSide - 1);
    // columns of a RAS image, in LPS
    geometry.indexToPhysical = Mat3::diagonal(-step.x, -step.y, step.z);
    const Vec3 middle = 0.5 * (box.minimum + box.maximum);
    geometry.originMm = lpsToRas(middle - 0.5 * double(kSide - 1) * step);
    return nifti(geometry, std::vector<std::uint8_t>(kSide * kSide * kSide));
}

std::string mz3Of(const SceneSurface& surface) {
    constexpr std::uint16_t kFaces = 1, kVertices = 2, kColors = 4;
    const SceneMesh& mesh = surface.mesh;
    std::vector<std::int32_t> newNumber(static_cast<std::size_t>(mesh.pointCount()), -1);
    std::vector<VertexId> used;
    mesh.forEachTriangle([&](const Triangle& t) {
        for (const VertexId v : t) {
            if (newNumber[v] >= 0) continue;
            newNumber[v] = static_cast<std::int32_t>(used.size());
            used.push_back(v);
        }
    });
    const bool hasColors = !surface.valuesMm.empty();
    std::string bytes;
    append<std::uint16_t>(bytes, 0x5A4D);
    append<std::uint16_t>(bytes, kFaces | kVertices | (hasColors ? kColors : 0));
    append<std::uint32_t>(bytes, static_cast<std::uint32_t>(mesh.triangleCount()));
    append<std::uint32_t>(bytes, static_cast<std::uint32_t>(used.size()));
    append<std::uint32_t>(bytes, 0);
    mesh.forEachTriangle([&](const Triangle& t) {
        for (const VertexId v : t) append<std::int32_t>(bytes, newNumber[v]);
    });
    for (const VertexId v : used) {
        for (int axis = 0; axis < 3; ++axis) {
            append<float>(bytes, static_cast<float>(mesh.point(v)[axis]));
        }
    }
    for (const VertexId v : hasColors ? used : std::vector<VertexId>{}) {
        for (const std::uint8_t channel : viridis(surface.valuesMm[v] / surface.largestValueMm)) {
            append(bytes, channel);
        }
        append<std::uint8_t>(bytes, 255);
    }
    return bytes;
}

}  // namespace adaptiso
