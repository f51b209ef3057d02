#include "DicomFolder.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "ByteSource.h"
#include "FileFault.h"
#include "HeaderText.h"
#include "Readers.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ForeignContent.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/Shortage.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view kDirectoryStorage = "1.2.840.10008.1.3.10";  // DICOMDIR
constexpr std::size_t kMagicEnd = 132;
constexpr const char* kGetOrRemove = "get it again or remove it";
constexpr const char* kDecompress = "decompress it, e.g. with gunzip, or remove it";

bool hasDicomName(const fs::path& file) {
    const std::string ending = lowerCase(file.extension().native());
    return ending == ".dcm" || ending == ".ima" || ending == ".dicom";
}

/// A DICOM file that somebody has compressed as a whole, by its name or, for gzip, its content.
bool isCompressedDicom(const fs::path& file, std::string_view head) {
    const std::string ending = lowerCase(file.extension().native());
    for (const std::string_view packed : {".gz", ".bz2", ".xz", ".zst", ".z", ".zip"}) {
        if (ending == packed && hasDicomName(file.stem())) return true;
    }
    if (!head.starts_with("\x1f\x8b")) return false;
    try {
        return isGzippedDicom(file);
    } catch (const FileError&) {
        return false;  // damaged, and nothing says that it was a slice
    }
}

bool isHidden(const fs::path& path) {
    return path.filename().native().starts_with('.');
}

/// True for objects with an image: known for DICOM's own classes; a vendor's have Rows.
enum class ObjectKind { Image, NoImage, VendorsWithoutImage };

ObjectKind objectKind(const DicomHeader& header) {
    constexpr std::string_view kDicom = "1.2.840.10008.", kStorage = "1.2.840.10008.5.1.4.1.1.";
    std::string_view storage = header.mediaStorage;
    if (!storage.starts_with(kDicom)) {
        const bool isImage = storage.empty() || header.dataset.integer(tag::kRows).value_or(0) > 0;
        return isImage ? ObjectKind::Image : ObjectKind::VendorsWithoutImage;
    }
    if (!storage.starts_with(kStorage)) return ObjectKind::NoImage;
    storage.remove_prefix(kStorage.size());
    if (storage == "4.2") return ObjectKind::NoImage;  // MR spectroscopy
    // CR, CT, ultrasound, MR, NM, secondary capture, X-ray, parametric maps, segmentations, visible
    // light, PET, RT image
    for (const std::string_view kind : {"1", "2", "3", "4", "5", "6", "7", "12", "13", "14", "20",
                                        "30", "66.4", "66.7", "77", "128", "130", "481.1"}) {
        const bool isOf = storage.starts_with(kind) &&
                          (storage.size() == kind.size() || storage[kind.size()] == '.');
        if (isOf) return ObjectKind::Image;
    }
    return ObjectKind::NoImage;
}

/// Lower case, numbers as '#': the names of one series' files mostly share it.
std::string namePattern(const fs::path& file) {
    std::string pattern;
    for (const char c : lowerCase(file.filename().native())) {
        const bool isDigit = c >= '0' && c <= '9';
        if (!isDigit || !pattern.ends_with('#')) pattern += isDigit ? '#' : c;
    }
    return pattern;
}

/// Documents, pictures and other formats' files may lie beside the slices, whatever they hold.
bool hasStrayName(const fs::path& file) {
    constexpr std::string_view kNames[] = {"dicomdir",  "readme",  "license", "licence", "copying",
                                           "changelog", "authors", "version", "makefile"};
    constexpr std::string_view kEndings[] = {
        ".txt", ".md",   ".rst",  ".json", ".xml",  ".html", ".htm",  ".css", ".js",  ".csv",
        ".tsv", ".log",  ".pdf",  ".doc",  ".docx", ".xls",  ".xlsx", ".ppt", ".rtf", ".jpg",
        ".png", ".jpeg", ".gif",  ".bmp",  ".tif",  ".tiff", ".mp4",  ".avi", ".db",  ".ini",
        ".inf", ".exe",  ".dll",  ".jar",  ".ico",  ".cfg",  ".yml",  ".nii", ".gz",  ".nrrd",
        ".mat", ".yaml", ".bval", ".bvec", ".toml", ".py",   ".sh",   ".bat", ".zip", ".stl"};
    fs::path name = file.filename();
    if (lowerCase(name.extension().native()) == ".icloud") name = name.native().substr(1);
    if (lowerCase(name.extension().native()) == ".icloud") name.replace_extension();
    const std::string whole = lowerCase(name.native());
    return std::ranges::find(kNames, whole) != std::end(kNames) ||
           std::ranges::find(kEndings, lowerCase(name.extension().native())) != std::end(kEndings);
}

bool isPlaceholder(const fs::path& file) {
    return lowerCase(file.extension().native()) == ".icloud";
}

/// gdcm::Directory stops at the first broken link or pipe, so folders are walked here.
class FolderWalk {
public:
    FolderWalk(const fs::path& folder, DamagedFiles treatment)
        : folder_(folder), treatment_(treatment) {
        walk(folder, 0);
        std::ranges::sort(dicomFiles_);
        refuseStandIns();
        if (dicomFiles_.empty()) refuseOtherFormat();
    }

    const std::vector<fs::path>& dicomFiles() const { return dicomFiles_; }
    const std::vector<DicomFault>& damaged() const { return damaged_; }
    std::size_t oddEntries() const { return oddEntries_; }
    std::size_t compressedCopies() const { return compressedCopies_; }

private:
    void walk(const fs::path& folder, int depth) {
        constexpr int kDeepest = 64;
        if (depth > kDeepest) {
            refuse(folder_, fmt::format("holds folders more than {} deep", kDeepest),
                   "give the folder of one series");
        }
        std::error_code error;
        std::vector<fs::path> subfolders;
        fs::directory_iterator it(folder, error);
        for (const fs::directory_iterator end; !error && it != end; it.increment(error)) {
            countEntry();
            std::error_code ignored;
            const fs::file_status status = it->status(ignored);
            if (!fs::is_directory(status)) {
                tryFile(it->path(), status);
            } else if (it->is_symlink(ignored)) {
                ++oddEntries_;
            } else if (!isHidden(it->path())) {
                subfolders.push_back(it->path());
            }
        }
        if (error) refuse(folder, "can't be listed: " + error.message(), "check its permissions");
        std::ranges::sort(subfolders);
        for (const fs::path& subfolder : subfolders) walk(subfolder, depth + 1);
    }

    /// Somebody's whole disk would take minutes.
    void countEntry() {
        constexpr std::size_t kMostEntries = 200'000;
        if (++entries_ > kMostEntries) {
            refuse(folder_, fmt::format("holds more than {} files and folders", kMostEntries),
                   "give the folder of one series");
        }
    }

    void tryFile(const fs::path& entry, const fs::file_status& status) {
        try {
            takeFile(entry, status);
        } catch (const FileError& error) {
            if (treatment_ == DamagedFiles::Refuse) throw;
            damaged_.push_back({entry, withoutName(error.what(), entry)});
        }
    }

    void takeFile(const fs::path& entry, const fs::file_status& status) {
        if (status.type() == fs::file_type::not_found) {
            refuse(entry, "the link points to no existing file, a slice may be missing",
                   "fetch the file (git annex get) or remove the link");
        }
        if (!fs::is_regular_file(status)) {
            ++oddEntries_;
            return;
        }
        requireRegularFile(entry);
        std::error_code ignored;
        if (fs::is_symlink(entry, ignored)) requireIn(entry, folder_);
        const std::string head = readHead(entry, kMagicEnd);
        if (looksLikeDicom(head)) {
            dicomFiles_.push_back(entry);
        } else if (!isHidden(entry) && isCompressedDicom(entry, head)) {
            takeCompressed(entry);
        } else if (!isHidden(entry) || isPlaceholder(entry)) {
            others_.push_back(entry);
        }
    }

    /// Files in a slice's place that hold none: pointers, placeholders, web pages, zeros, nothing;
    /// and whatever is named like a slice and is no DICOM.
    void refuseStandIns() {
        std::set<fs::path> sliceNames;
        for (const fs::path& file : dicomFiles_) {
            sliceNames.insert(file.parent_path() / namePattern(file));
        }
        std::vector<DicomFault> found;
        std::string remedy;  // of the first; it may hold the file's name, which lists do not show
        std::ranges::sort(others_);
        for (const fs::path& file : others_) {
            const bool isNamedSo =
                hasDicomName(file) || sliceNames.contains(file.parent_path() / namePattern(file));
            if (!isNamedSo && hasStrayName(file)) continue;
            const auto foreign = findForeignContent(file);
            if (!isNamedSo && (!foreign || foreign->kind != ForeignKind::StandIn)) continue;
            if (found.empty()) remedy = foreign ? foreign->remedy + ", or remove it" : kGetOrRemove;
            found.push_back(
                {file, (foreign ? foreign->fault : "is named like a DICOM file but is not one") +
                           ": a slice would be missing"});
        }
        if (!found.empty() && treatment_ == DamagedFiles::Refuse) {
            const std::string more =
                found.size() > 1 ? fmt::format(" ({} such files)", found.size()) : "";
            throw FileError(fmt::format("{}{}: {}; {}", displayName(found[0].file), more,
                                        found[0].fault, remedy));
        }
        damaged_.insert(damaged_.end(), found.begin(), found.end());
    }

    /// Slices as pictures, most often.
    void refuseOtherFormat() {
        refuseImages();  // first: their sidecars are of other formats
        for (const fs::path& file : others_) {
            const auto foreign = findForeignContent(file);
            if (!foreign || foreign->kind == ForeignKind::StandIn) continue;
            refuse(folder_,
                   fmt::format("no DICOM file found in this folder: {} {}",
                               fileNumber(file, folder_), foreign->fault),
                   foreign->remedy);
        }
    }

    /// Images of other formats, as for a batch.
    void refuseImages() {
        const auto ending = [](const fs::path& file) {
            return lowerCase((file.extension() == ".gz" ? file.stem().extension().string() : "") +
                             file.extension().string());
        };
        const auto isBelow = [&](const fs::path& file) {
            return file.lexically_relative(folder_).has_parent_path();
        };
        for (const fs::path& first : others_) {
            const std::string_view format = recognizeImage(first);
            if (format.empty() || isHidden(first)) continue;
            const auto count = std::ranges::count(others_, ending(first), ending);
            refuse(folder_,
                   fmt::format("no DICOM file found in this folder: it holds {} {} file{}", count,
                               format, count == 1 ? "" : "s"),
                   count == 1
                       ? "give the file"
                       : "give one of them; a batch takes all: " +
                             (isBelow(first)
                                  ? fmt::format("--list takes what find {} -name '*{}' prints",
                                                folder_.string(), ending(first))
                                  : (folder_ / ("*" + ending(first))).string()));
        }
    }

    /// One that lies beside what it holds is a copy; alone, it is a slice that would be missing.
    void takeCompressed(const fs::path& entry) {
        std::error_code ignored;
        const fs::path slice = fs::path(entry).replace_extension();
        if (slice == entry || !fs::is_regular_file(slice, ignored)) {
            refuse(entry, "is a compressed DICOM file: a slice would be missing", kDecompress);
        }
        ++compressedCopies_;
    }

    const fs::path& folder_;
    DamagedFiles treatment_;
    std::vector<fs::path> dicomFiles_;
    std::vector<fs::path> others_;  ///< neither DICOM nor a copy of it
    std::vector<DicomFault> damaged_;
    std::size_t oddEntries_ = 0;  ///< pipes, devices, link loops, links to folders
    std::size_t compressedCopies_ = 0;
    std::size_t entries_ = 0;
};

/// Sorts one file's header into `input`.
void takeHeader(const fs::path& path, DicomHeader header, DicomInput& input) {
    if (header.pixelData || header.hasFloatPixelData) {
        input.files.push_back({path, std::move(header)});
    } else if (const ObjectKind kind = objectKind(header); kind != ObjectKind::Image) {
        ++input.otherFiles;
        if (kind == ObjectKind::VendorsWithoutImage) ++input.vendorFiles;
    } else {
        refuse(path, "is a DICOM image without pixel data, a slice may be cut off", kGetOrRemove);
    }
}

void requireDicom(const fs::path& path) {
    if (!looksLikeDicom(readHead(path, kMagicEnd))) refuseForeignContent(path);
}

bool isSameFile(const fs::path& a, const fs::path& b) {
    std::error_code error;
    if (fs::file_size(a, error) != fs::file_size(b, error) || error) return false;
    std::ifstream first(a, std::ios::binary), second(b, std::ios::binary);
    return first && second &&
           std::equal(std::istreambuf_iterator<char>(first), std::istreambuf_iterator<char>(),
                      std::istreambuf_iterator<char>(second));
}

/// Files with another one's SOPInstanceUID that are the same to the byte.
void leaveOutCopies(DicomInput& input) {
    std::map<std::string_view, std::vector<const DicomFile*>> known;
    std::vector<bool> isCopy;
    for (const DicomFile& file : input.files) {
        const std::string_view uid = file.header.dataset.text(tag::kSopInstance).value_or("");
        auto& others = known[uid];
        isCopy.push_back(!uid.empty() && std::ranges::any_of(others, [&](const DicomFile* other) {
            return other->header.dataset.values == file.header.dataset.values &&
                   isSameFile(other->path, file.path);
        }));
        if (!isCopy.back()) others.push_back(&file);
    }
    const auto copies = std::ranges::count(isCopy, true);
    if (copies == 0) return;
    std::vector<DicomFile> kept;
    for (std::size_t n = 0; n < isCopy.size(); ++n) {
        if (!isCopy[n]) kept.push_back(std::move(input.files[n]));
    }
    input.files = std::move(kept);
    input.warnings.push_back(
        {"copies-left-out", fmt::format("left out {} that {} of others",
                                        copies == 1 ? "1 file" : fmt::format("{} files", copies),
                                        copies == 1 ? "is an exact copy" : "are exact copies")});
}

DicomInput readHeaders(const std::vector<fs::path>& paths, DamagedFiles damaged,
                       bool keepsDescription) {
    DicomInput input;
    for (const fs::path& path : paths) {
        try {
            requireDicom(path);
            takeHeader(path, readDicomHeader(path, keepsDescription), input);
        } catch (const FileError& error) {
            if (damaged == DamagedFiles::Refuse) throw;
            input.damaged.push_back({path, withoutName(error.what(), path)});
        }
    }
    leaveOutCopies(input);
    if (input.vendorFiles > 0) {
        input.warnings.push_back(
            {"objects-left-aside",
             fmt::format("left aside: {} of a vendor's own kind, without an image",
                         input.vendorFiles == 1
                             ? "1 DICOM file"
                             : fmt::format("{} DICOM files", input.vendorFiles))});
    }
    return input;
}

void requireImages(const fs::path& where, const DicomInput& input, std::string_view what) {
    if (!input.files.empty() || !input.damaged.empty()) return;
    refuse(where,
           input.otherFiles == 0
               ? fmt::format("no DICOM file found in {}", what)
               : fmt::format("no image found: {} DICOM files without pixel data", input.otherFiles),
           "give an image file or the folder that holds the slices");
}

/// A DICOMDIR's name for a file: its folders and its name, cut at backslashes (PS3.10, 8.2).
fs::path referencedFile(const fs::path& directory, std::string_view id) {
    fs::path path = directory.parent_path(), lower = path;
    for (std::string_view rest = id;;) {
        const std::size_t cut = rest.find('\\');
        const std::string_view part = trimmed(rest.substr(0, cut));
        if (part.empty() || part == "." || part == ".." ||
            part.find('/') != std::string_view::npos) {
            refuse(directory, "names a file outside its own folder", "repair the DICOMDIR");
        }
        path /= part;
        lower /= lowerCase(part);
        if (cut == std::string_view::npos) break;
        rest.remove_prefix(cut + 1);
    }
    std::error_code ignored;
    if (!fs::exists(path, ignored) && fs::exists(lower, ignored)) return lower;
    return path;
}

std::vector<fs::path> referencedFiles(const fs::path& directory, const DicomHeader& header) {
    std::set<fs::path> paths;
    const auto records = header.dataset.sequences.find(tag::kDirectoryRecordSequence);
    if (records == header.dataset.sequences.end()) return {};
    for (const DicomDataset& record : records->second) {
        const auto id = record.text(tag::kReferencedFileId);
        if (!id) continue;
        const fs::path path = referencedFile(directory, *id);
        std::error_code ignored;
        if (!fs::exists(path, ignored)) {
            refuse(directory,
                   fmt::format("names a file that is not there ({}): a slice may be missing",
                               printable(*id)),
                   "copy all files of the medium, or give the folder that holds the slices");
        }
        requireBeside(path, directory);
        paths.insert(path);
    }
    return {paths.begin(), paths.end()};
}

/// All files in and under a folder, which may be "" for this one.
std::vector<fs::path> filesBelow(const fs::path& folder) {
    std::error_code error, ignored;
    std::vector<fs::path> files;
    fs::recursive_directory_iterator entry(folder.empty() ? fs::path(".") : folder, error);
    for (const fs::recursive_directory_iterator end; !error && entry != end;
         entry.increment(error)) {
        if (entry->is_directory(ignored)) continue;
        files.push_back(folder.empty() ? entry->path().lexically_normal() : entry->path());
    }
    return files;
}

}  // namespace

bool isGzippedDicom(const fs::path& file) {
    std::string head(132, '\0');
    head.resize(
        ByteSource(file, 0, ByteSource::Encoding::Deflate).readSome(head.data(), head.size()));
    return looksLikeDicom(head);
}

std::string fileNumber(const fs::path& file, const fs::path& folder) {
    const std::vector<fs::path> files = filesBelow(folder);
    const auto before = std::ranges::count_if(files, [&](const auto& each) { return each < file; });
    return fmt::format("file {} (by name)", before + 1);
}

ReadVolume numberingFiles(const fs::path& input, const fs::path& folder,
                          const std::function<ReadVolume()>& read) {
    const auto numbered = [&](const std::string& message) {
        for (const fs::path& file : filesBelow(folder)) {
            const std::string name = displayName(file);
            if (!message.starts_with(name + ": ") && !message.starts_with(name + " (")) continue;
            return displayName(input) + ": " + fileNumber(file, folder) +
                   message.substr(name.size());
        }
        return message;
    };
    try {
        return read();
    } catch (const Shortage& error) {
        throw Shortage(numbered(error.what()));
    } catch (const ChoiceNeeded&) {
        throw;  // it names no slice
    } catch (const FileError& error) {
        throw FileError(numbered(error.what()));
    }
}

std::string withoutName(const std::string& message, const fs::path& file) {
    const std::string prefix = displayName(file) + ": ";
    return message.starts_with(prefix) ? message.substr(prefix.size()) : message;
}

DicomInput readDicomHeaders(const fs::path& folder, DamagedFiles damaged, bool keepsDescription) {
    const FolderWalk walk(folder, damaged);
    DicomInput input = readHeaders(walk.dicomFiles(), damaged, keepsDescription);
    input.damaged.insert(input.damaged.end(), walk.damaged().begin(), walk.damaged().end());
    requireImages(folder, input, "this folder");
    if (walk.oddEntries() > 0) {
        input.warnings.push_back(
            {"entries-left-out",

             fmt::format("left out {} entries of the folder that are no regular files (pipes, "
                         "links to folders, link loops)",
                         walk.oddEntries())});
    }
    if (walk.compressedCopies() > 0) {
        input.warnings.push_back(
            {"copies-left-out",

             fmt::format("left out {} compressed files that lie beside files of the same name",
                         walk.compressedCopies())});
    }
    return input;
}

DicomInput readDicomFileHeaders(const fs::path& file, DamagedFiles damaged, bool keepsDescription) {
    DicomHeader header = readDicomHeader(file, keepsDescription);
    if (header.mediaStorage == kDirectoryStorage) {
        DicomInput input = readHeaders(referencedFiles(file, header), damaged, keepsDescription);
        requireImages(file, input, "this DICOMDIR");
        return input;
    }
    if (!header.pixelData && !header.hasFloatPixelData) {
        refuse(file, "holds no image (no pixel data)", "give an image file or a DICOM folder");
    }
    DicomInput input;
    input.files.push_back({file, std::move(header)});
    return input;
}

}  // namespace adaptiso::detail
