#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "DicomPixels.h"
#include "FileFault.h"
#include "Samples.h"

// Rescaled here because itk::ImageSeriesReader takes one slice's rescale for all.
namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

bool isWhole(double value) {
    return value == std::floor(value) && std::abs(value) < 1e9;
}

/// The stored type where nothing is rescaled; the smallest integer type that holds all values where
/// slopes are 1 and intercepts whole; else a float type.
PixelType outputTypeOf(const std::vector<DicomPixelFormat>& formats,
                       const std::vector<DicomPlane>& planes) {
    const PixelType stored = formats[planes.front().file].stored;
    bool isPlain = true, isInteger = true, isWide = false;
    double low = 0, high = 0;
    for (const DicomPlane& plane : planes) {
        const DicomPixelFormat& format = formats[plane.file];
        const bool isIdentity = plane.slope == 1 && plane.intercept == 0;
        isPlain = isPlain && isIdentity && format.stored == stored;
        isInteger = isInteger && plane.slope == 1 && isWhole(plane.intercept);
        isWide = isWide || bytesPerPixel(format.stored) > 2;
        const bool isSigned = format.isSigned();
        const double values = std::ldexp(1, format.bitsStored);
        low = std::min(low, plane.intercept - (isSigned ? values / 2 : 0));
        high = std::max(high, plane.intercept + (isSigned ? values / 2 : values) - 1);
    }
    if (isPlain) return stored;
    if (!isInteger) return isWide ? PixelType::Float64 : PixelType::Float32;
    for (const PixelType type : {PixelType::UInt8, PixelType::Int8, PixelType::UInt16,
                                 PixelType::Int16, PixelType::UInt32, PixelType::Int32}) {
        const bool holds = withPixelType(type, [&]<class T>(T) {
            return low >= static_cast<double>(std::numeric_limits<T>::lowest()) &&
                   high <= static_cast<double>(std::numeric_limits<T>::max());
        });
        if (holds) return type;
    }
    return PixelType::Int64;
}

template <class Stored, class Out>
void rescaleRow(const DicomPlane& plane, const Stored* in, std::int64_t count, Out* out) {
    for (std::int64_t i = 0; i < count; ++i) {
        const double value = plane.slope * static_cast<double>(in[i]) + plane.intercept;
        out[i] = static_cast<Out>(value);
    }
}

/// Rescaling is by what fits into the samples' type: nothing may become infinite.
void requireFiniteRescale(const DicomFile& dicom, const DicomPixelFormat& format,
                          const DicomPlane& plane, PixelType type) {
    const double most = std::ldexp(1, format.bitsStored);  // beyond any stored value
    const double largest = std::abs(plane.slope) * most + std::abs(plane.intercept);
    const double limit = type == PixelType::Float32 ? std::numeric_limits<float>::max()
                                                    : std::numeric_limits<double>::max();
    if (largest <= limit) return;
    refuse(dicom.path,
           fmt::format("its RescaleSlope {} and RescaleIntercept {} make values infinite",
                       number(plane.slope), number(plane.intercept)),
           "get the file again");
}

/// Tiles of a mosaic behind its last slice hold one value, 0 as a rule.
/// \return slices that hold one value: they may be missing
std::int64_t requireBlankTiles(const DicomFile& dicom, const DicomPixelFormat& format,
                               const std::vector<std::byte>& frame, std::int64_t columns,
                               std::int64_t rows, std::int64_t slices) {
    const std::int64_t across = format.columns / columns, tiles = across * (format.rows / rows);
    std::int64_t blank = 0;
    withPixelType(format.stored, [&]<class Stored>(Stored) {
        const auto* const pixels = reinterpret_cast<const Stored*>(frame.data());
        const auto isBlank = [&](std::int64_t tile) {
            const Stored* row =
                pixels + tile / across * rows * format.columns + tile % across * columns;
            const Stored corner = *row;
            for (std::int64_t n = 0; n < rows; ++n, row += format.columns) {
                if (!std::all_of(row, row + columns, [&](Stored s) { return s == corner; })) {
                    return false;
                }
            }
            return true;
        };
        for (std::int64_t tile = 0; tile < tiles; ++tile) {
            if (isBlank(tile)) {
                blank += tile < slices ? 1 : 0;
            } else if (tile >= slices) {
                refuse(
                    dicom.path,
                    fmt::format("is a Siemens mosaic of {} slices by its header, but its tile {} "
                                "holds an image too",
                                slices, tile + 1),
                    "convert it with dcm2niix first");
            }
        }
    });
    return blank;
}

/// Where decoded planes go.
struct SliceStore {
    std::byte* samples;
    PixelType type;
    std::int64_t columns, rows;  ///< of a slice

    /// \param frame  the decoded frame; of a mosaic, `plane` is one of its tiles
    void store(const DicomPixelFormat& format, const DicomPlane& plane,
               const std::vector<std::byte>& frame, std::size_t slice) const {
        const bool isCopy = format.stored == type && plane.slope == 1 && plane.intercept == 0;
        const std::size_t bytesIn = bytesPerPixel(format.stored), bytesOut = bytesPerPixel(type);
        for (std::int64_t row = 0; row < rows; ++row) {
            const std::byte* in =
                frame.data() +
                bytesIn * static_cast<std::size_t>((plane.firstRow + row) * format.columns +
                                                   plane.firstColumn);
            std::byte* out =
                samples + bytesOut * static_cast<std::size_t>(
                                         (static_cast<std::int64_t>(slice) * rows + row) * columns);
            if (isCopy) {
                std::memcpy(out, in, static_cast<std::size_t>(columns) * bytesOut);
                continue;
            }
            withPixelType(format.stored, [&]<class Stored>(Stored) {
                withPixelType(type, [&]<class Out>(Out) {
                    rescaleRow(plane, reinterpret_cast<const Stored*>(in), columns,
                               reinterpret_cast<Out*>(out));
                });
            });
        }
    }
};

/// The planes of a stack, as they are.
Volume decodePlanes(const fs::path& input, const std::vector<DicomFile>& files,
                    const DicomStack& stack, std::vector<Warning>& warnings) {
    std::vector<DicomPixelFormat> formats(files.size());
    std::vector<std::vector<std::size_t>> slicesOfFile(files.size());
    for (std::size_t slice = 0; slice < stack.planes.size(); ++slice) {
        const std::size_t file = stack.planes[slice].file;
        if (slicesOfFile[file].empty()) formats[file] = dicomPixelFormat(files[file]);
        slicesOfFile[file].push_back(slice);
    }
    const PixelType type = outputTypeOf(formats, stack.planes);
    ImageGeometry geometry = stack.geometry;
    if (stack.slices.empty()) geometry.size[2] = std::ssize(stack.planes);
    const std::uint64_t byteCount = requireImageBytes(input, geometry.size, type);
    SampleBuffer samples = allocateSamples(input, byteCount);
    if (!stack.slices.empty()) std::memset(samples.get(), 0, byteCount);
    const SliceStore store{samples.get(), type, geometry.size[0], geometry.size[1]};

    std::vector<std::byte> frame;
    std::size_t filesWithStrayBits = 0, filesWithPadding = 0, filesWithMore = 0;
    std::uint64_t mostBehind = 0;
    for (std::size_t file = 0; file < files.size(); ++file) {
        std::vector<std::size_t>& slices = slicesOfFile[file];
        if (slices.empty()) continue;
        std::ranges::stable_sort(slices, {}, [&](std::size_t n) { return stack.planes[n].frame; });
        DicomFrames frames(files[file], formats[file]);
        std::int64_t decoded = -1;
        for (const std::size_t slice : slices) {
            const DicomPlane& plane = stack.planes[slice];
            requireFiniteRescale(files[file], formats[file], plane, type);
            if (plane.frame != decoded) frames.read(plane.frame, frame);  // tiles share theirs
            decoded = plane.frame;
            store.store(formats[file], plane, frame,
                        stack.slices.empty() ? slice : stack.slices[slice]);
        }
        if (isSiemensMosaic(files[file].header)) {
            const std::int64_t blank = requireBlankTiles(
                files[file], formats[file], frame, store.columns, store.rows, std::ssize(slices));
            const auto imageType = files[file].header.dataset.text(tag::kImageType).value_or("");
            if (blank > 0 && imageType.starts_with("ORIGINAL")) {
                warnings.push_back(
                    {"fewer-images",
                     fmt::format("its header counts {} slices (NumberOfImagesInMosaic), {} of them "
                                 "hold one value: they may be missing",
                                 slices.size(), blank)});
            }
        }
        filesWithStrayBits += frames.hasStrayBits() ? 1 : 0;
        filesWithPadding += frames.hasPadding() ? 1 : 0;
        filesWithMore += files[file].header.bytesBehind > 0 ? 1 : 0;
        mostBehind = std::max(mostBehind, files[file].header.bytesBehind);
    }
    if (filesWithMore > 0) {
        warnings.push_back(
            {"trailing-bytes", fmt::format("{} of its files hold bytes behind their data set, at "
                                           "most {}; they were left out",
                                           filesWithMore, mostBehind)});
    }
    if (filesWithPadding > 0) {
        warnings.push_back(
            {"trailing-bytes",
             fmt::format(
                 "{} files hold a few bytes more of pixel data than their header describes: "
                 "left out",
                 filesWithPadding)});
    }
    if (filesWithStrayBits > 0) {
        warnings.push_back(
            {"stray-bits", fmt::format("{} files have bits set above HighBit, which are no part of "
                                       "their samples: left out",
                                       filesWithStrayBits)});
    }
    return makeVolume(std::move(samples), type, geometry);
}

template <class In, class Out>
void blendSlices(const TypedVolumeView<In>& in, const std::vector<SliceBlend>& blends, Out* out) {
    for (const SliceBlend& blend : blends) {
        const In* before = in.samples + static_cast<std::int64_t>(blend.before) * in.strideZ();
        const In* after = before + in.strideZ();
        for (std::int64_t n = 0; n < in.strideZ(); ++n) {
            *out++ = static_cast<Out>((1 - blend.weight) * static_cast<double>(before[n]) +
                                      blend.weight * static_cast<double>(after[n]));
        }
    }
}

Volume blend(const fs::path& input, const Volume& planes, const DicomStack& stack) {
    const VolumeView& view = planes.view();
    const PixelType type =
        view.pixelType() == PixelType::Float64 ? view.pixelType() : floatTypeFor(view.pixelType());
    SampleBuffer samples =
        allocateSamples(input, requireImageBytes(input, stack.geometry.size, type));
    dispatchPixelType(view, [&](const auto& typed) {
        if (type == PixelType::Float64) {
            blendSlices(typed, stack.blends, reinterpret_cast<double*>(samples.get()));
        } else {
            blendSlices(typed, stack.blends, reinterpret_cast<float*>(samples.get()));
        }
    });
    return makeVolume(std::move(samples), type, stack.geometry);
}

}  // namespace

Volume decodeDicomStack(const fs::path& input, const std::vector<DicomFile>& files,
                        const DicomStack& stack, std::vector<Warning>& warnings) {
    const Volume planes = decodePlanes(input, files, stack, warnings);
    return stack.blends.empty() ? planes : blend(input, planes, stack);
}

}  // namespace adaptiso::detail
