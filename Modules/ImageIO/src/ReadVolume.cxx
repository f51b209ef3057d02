#include "adaptiso/ImageIO/ReadVolume.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <optional>
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

/// A reader of ours.
struct Reader {
    std::string_view format;
    ReadVolume (*read)(const fs::path&, const ReadOptions&);
};

Reader readerOfFolder(const fs::path& folder) {
    if (detail::isZarrFolder(folder)) return Reader{"Zarr", detail::readZarr};
    return Reader{"DICOM", detail::readDicomFolder};
}

/// \param head, inflated  the first bytes as they are and unpacked
std::optional<Reader> readerOfFile(const fs::path& file, std::string_view head,
                                   std::string_view inflated) {
    const Reader nifti{"NIfTI", detail::readNifti}, meta{"MetaImage", detail::readMetaImage};
    if (detail::looksLikeNrrd(head)) return Reader{"NRRD", detail::readNrrd};
    if (detail::looksLikeMetaImage(head)) return meta;
    if (detail::looksLikeNifti(inflated)) return nifti;
    // content that only its name explains, or a damaged file whose reader says best what is wrong
    const std::string ending = formatEnding(file);
    if (ending == "nii" || ending == "hdr" || ending == "img") return nifti;
    if (ending == "mgh" || ending == "mgz") return Reader{"MGH", detail::readMgh};
    if (ending == "mha" || ending == "mhd") return meta;
    const bool isMrc = head.size() >= 212 && head.substr(208, 4) == "MAP ";  // its width may be 8
    if (detail::looksLikeDicom(head) && !isMrc) return Reader{"DICOM", detail::readDicomFile};
    return std::nullopt;
}

/// TIFF, HDF5 and netCDF, which may hold a volume for ITK's readers; all else where it has
/// plug-ins.
bool mayBeItks(std::string_view head) {
    using namespace std::string_view_literals;
    const char* const plugIns = std::getenv("ITK_AUTOLOAD_PATH");
    if (plugIns != nullptr && *plugIns != '\0') return true;
    return std::ranges::any_of(std::array{"II*\0"sv, "MM\0*"sv, "CDF\1"sv, "CDF\2"sv, "\x89HDF"sv},
                               [&](std::string_view magic) { return head.starts_with(magic); });
}

ReadVolume readAnyFormat(const fs::path& input, const ReadOptions& options) {
    std::error_code error;
    if (fs::is_directory(input, error)) return readerOfFolder(input).read(input, options);
    detail::requireRegularFile(input);

    const std::string head = detail::readHead(input, kHeadBytes);
    const std::string inflated = inflatedHead(input);
    const auto reader = readerOfFile(input, head, inflated);
    const bool isSure = reader && (reader->format == "DICOM" || detail::looksLikeNrrd(head) ||
                                   detail::looksLikeMetaImage(head));
    if (!isSure && !reader && mayBeItks(inflated)) {
        if (auto read = detail::readWithItk(input, options)) return std::move(*read);
    }
    if (!isSure) refuseForeign(input, head, inflated);
    if (reader) return reader->read(input, options);
    if (auto read = detail::readWithItk(input, options)) return std::move(*read);
    for (const auto looksLikeOne :
         {detail::looksLikeDicom, detail::looksLikeNrrd, detail::looksLikeMetaImage}) {
        if (head == inflated || !looksLikeOne(inflated)) continue;
        detail::refuse(input, "is compressed as a whole, as its format is not",
                       "decompress it, e.g. with gunzip");
    }
    const std::string others = detail::withoutItkText();
    detail::refuse(input, "not a format that is read here",
                   "give NIfTI, NRRD, MetaImage, MGH, DICOM, or a folder of Zarr" +
                       (others.empty() ? "" : "; " + others));
}

/// \throws InvalidInput  an option of another format
void requireOptionsOf(const std::string& format, const fs::path& input,
                      const ReadOptions& options) {
    std::error_code error;
    const bool hasChunks = fs::is_directory(input, error) && detail::isZarrFolder(input);
    const std::string is = input.string() + " is " + format;
    if (options.series && format != "DICOM") {
        throw InvalidInput("--series " + *options.series + ": " + is +
                           ", which has no series; leave --series out");
    }
    const bool asksForChunks =
        options.level || options.channel || options.timePoint || options.refusesMissingChunks;
    if (asksForChunks && !hasChunks) {
        throw InvalidInput("--level, --channel, --time, --refuse-missing-chunks: " + is +
                           ", and these are for Zarr and N5; leave them out");
    }
    if (options.space && !hasChunks && format != "NRRD") {
        throw InvalidInput("--image-space: " + is +
                           ", and it is for NRRD, Zarr and N5; leave it out");
    }
}

}  // namespace

ReadVolume readVolume(const fs::path& input, const ReadOptions& options) {
    ReadVolume read = readAnyFormat(input, options);
    requireOptionsOf(read.format, input, options);
    warnOfOddSamples(read);
    return read;
}

std::string_view recognizeImage(const fs::path& input) {
    try {
        std::error_code error;
        if (fs::is_directory(input, error)) return readerOfFolder(input).format;
        detail::requireRegularFile(input);
        const auto reader =
            readerOfFile(input, detail::readHead(input, kHeadBytes), inflatedHead(input));
        return reader ? reader->format : std::string_view();
    } catch (const Error&) {
        return {};
    }
}

}  // namespace adaptiso
