#include "adaptiso/ImageIO/ReadVolume.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <type_traits>

#include "ByteSource.h"
#include "FileFault.h"
#include "HeaderText.h"
#include "Readers.h"
#include "ZarrScene.h"
#include "adaptiso/Core/ForeignContent.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kHeadBytes = kForeignHeadBytes;  // NIfTI-1's magic ends at 348

/// The first bytes, inflated where the file is gzip.
std::string inflatedHead(const fs::path& file) {
    std::string head(kHeadBytes, '\0');
    head.resize(detail::ByteSource::openPlainOrGzip(file).readSome(head.data(), head.size()));
    return head;
}

/// "nii" for both x.nii and x.nii.gz
std::string formatEnding(const fs::path& file) {
    fs::path name = file.filename();
    if (lowerCase(name.extension().native()) == ".gz") name = name.stem();
    const std::string ending = lowerCase(name.extension().native());
    return ending.empty() ? ending : ending.substr(1);
}

/// Voxels that `isOdd`.
template <class T, class Predicate>
std::int64_t countVoxels(const TypedVolumeView<T>& view, Predicate isOdd) {
    std::atomic<std::int64_t> count{0};
    parallelForPieces(view.geometry.voxelCount(), std::int64_t{1} << 20,
                      [&](std::int64_t begin, std::int64_t end) {
                          count += std::count_if(view.samples + begin, view.samples + end, isOdd);
                      });
    return count;
}

/// Warns of samples that isovalues, which are doubles, can't be compared with exactly.
void warnOfOddSamples(ReadVolume& read) {
    dispatchPixelType(read.volume, [&]<class T>(const TypedVolumeView<T>& view) {
        if constexpr (std::is_floating_point_v<T>) {
            const auto count = countVoxels(view, [](T value) { return !std::isfinite(value); });
            // where no voxel is a number there is no isovalue either, and the caller says so
            if (count > 0 && count < view.geometry.voxelCount()) {
                read.warnings.push_back(
                    {"not-finite",
                     fmt::format("{} of its voxels hold no finite number (NaN or infinity); NaN "
                                 "counts as outside",
                                 count)});
            }
        } else if constexpr (sizeof(T) == 8) {
            const auto count = countVoxels(view, [](T value) {
                constexpr T kExact = T{1} << 53;
                return value > kExact || (std::is_signed_v<T> && value < T{0} - kExact);
            });
            if (count > 0) {
                read.warnings.push_back(
                    {"large-integers",
                     fmt::format(
                         "{} of its voxels hold integers beyond 2^53, which isovalues can't "
                         "tell apart",
                         count)});
            }
        }
    });
}

/// \param head, inflated  the first bytes as they are and unpacked
void refuseForeign(const fs::path& input, std::string_view head, std::string_view inflated) {
    detail::refuseForeignContent(input);
    if (detail::looksLikeDicom(inflated) || head == inflated) return;
    const auto foreign = foreignContentOf(inflated, input, true);
    if (foreign) detail::refuse(input, foreign->fault, foreign->remedy);
}

ReadVolume readAnyFormat(const fs::path& input, const ReadOptions& options) {
    std::error_code error;
    if (fs::is_directory(input, error)) {
        if (detail::isZarrFolder(input)) return detail::readZarr(input, options);
        return detail::readDicomFolder(input, options);
    }
    detail::requireRegularFile(input);

    const std::string head = detail::readHead(input, kHeadBytes);
    if (detail::looksLikeNrrd(head)) return detail::readNrrd(input, options);
    if (detail::looksLikeMetaImage(head)) return detail::readMetaImage(input, options);
    const std::string inflated = inflatedHead(input);
    if (!detail::looksLikeDicom(head)) refuseForeign(input, head, inflated);
    if (detail::looksLikeNifti(inflated)) return detail::readNifti(input, options);

    // content that only its name explains, or a damaged file whose reader says best what is wrong
    const std::string ending = formatEnding(input);
    if (ending == "nii" || ending == "hdr" || ending == "img")
        return detail::readNifti(input, options);
    if (ending == "mgh" || ending == "mgz") return detail::readMgh(input, options);
    if (ending == "mha" || ending == "mhd") return detail::readMetaImage(input, options);
    if (detail::looksLikeDicom(head)) return detail::readDicomFile(input, options);
    for (const auto looksLikeOne :
         {detail::looksLikeDicom, detail::looksLikeNrrd, detail::looksLikeMetaImage}) {
        if (!looksLikeOne(inflated)) continue;
        detail::refuse(input, "is compressed as a whole, as its format is not",
                       "decompress it, e.g. with gunzip");
    }
    detail::refuse(input, "not a format that is read here",
                   "give NIfTI, NRRD, MetaImage, MGH, DICOM, or a folder of Zarr");
}

}  // namespace

ReadVolume readVolume(const fs::path& input, const ReadOptions& options) {
    ReadVolume read = readAnyFormat(input, options);
    warnOfOddSamples(read);
    return read;
}

}  // namespace adaptiso
