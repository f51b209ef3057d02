#include "adaptiso/ImageIO/ReadVolume.h"

#include <array>

#include "ByteSource.h"
#include "FileFault.h"
#include "HeaderText.h"
#include "Readers.h"

namespace adaptiso {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kHeadBytes = 548;  // NIfTI-1's magic ends at 348, NIfTI-2's header at 540

/// The first bytes, inflated where the file is gzip.
std::string inflatedHead(const fs::path& file) {
    std::string head(kHeadBytes, '\0');
    head.resize(detail::ByteSource::openPlainOrGzip(file).readSome(head.data(), head.size()));
    return head;
}

/// "nii" for both x.nii and x.nii.gz
std::string formatEnding(const fs::path& file) {
    fs::path name = file.filename();
    if (detail::lowerCase(name.extension().native()) == ".gz") name = name.stem();
    const std::string ending = detail::lowerCase(name.extension().native());
    return ending.empty() ? ending : ending.substr(1);
}

}  // namespace

ReadVolume readVolume(const fs::path& input, const ReadOptions& options) {
    std::error_code error;
    if (fs::is_directory(input, error)) return detail::readDicomFolder(input, options);
    detail::requireRegularFile(input);

    const std::string head = detail::readHead(input, kHeadBytes);
    if (head.empty()) detail::refuse(input, "is an empty file", "get the file again");
    if (detail::looksLikeNrrd(head)) return detail::readNrrd(input);
    if (detail::looksLikeMetaImage(head)) return detail::readMetaImage(input);
    if (detail::looksLikeNifti(inflatedHead(input))) return detail::readNifti(input);

    // content that only its name explains, or a damaged file whose reader says best what is wrong
    const std::string ending = formatEnding(input);
    if (ending == "nii" || ending == "hdr" || ending == "img") return detail::readNifti(input);
    if (ending == "mgh" || ending == "mgz") return detail::readMgh(input);
    if (ending == "mha" || ending == "mhd") return detail::readMetaImage(input);
    if (detail::looksLikeDicom(head)) return detail::readDicomFile(input, options);
    detail::refuse(input, "not a format that is read here",
                   "give NIfTI, NRRD, MetaImage, MGH, or DICOM");
}

}  // namespace adaptiso
