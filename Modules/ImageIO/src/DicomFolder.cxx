#include "DicomFolder.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "ByteSource.h"
#include "FileFault.h"
#include "HeaderText.h"
#include "Readers.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view kDirectoryStorage = "1.2.840.10008.1.3.10";  // DICOMDIR
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

/// DICOMDIR, reports, presentation states, plans and the like: what may lie beside the slices.
bool isOtherThanImage(const DicomHeader& header) {
    constexpr std::string_view kStorage = "1.2.840.10008.5.1.4.1.1.";
    std::string_view storage = header.mediaStorage;
    if (storage == kDirectoryStorage) return true;
    if (!storage.starts_with(kStorage)) return false;
    storage.remove_prefix(kStorage.size());
    for (const std::string_view kind :
         {"9.", "11.", "66", "67", "68.", "88.", "104.", "481.2", "481.3", "481.4", "481.5",
          "481.6", "481.7", "481.8", "481.9"}) {
        if (storage.starts_with(kind) && storage != "66.4") return true;  // 66.4: segmentation
    }
    return false;
}

/// A slice that lost its end, as interrupted copies do.
bool isBlankStub(std::string_view head, std::size_t wholeHead) {
    return head.size() < wholeHead && head.find_first_not_of('\0') == std::string_view::npos;
}

/// gdcm::Directory stops at the first broken link or pipe, so folders are walked here.
class FolderWalk {
public:
    FolderWalk(const fs::path& folder, DamagedFiles treatment)
        : folder_(folder), treatment_(treatment) {
        walk(folder, 0);
        std::ranges::sort(dicomFiles_);
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
        constexpr std::size_t kMagicEnd = 132;
        const std::string head = readHead(entry, kMagicEnd);
        if (looksLikeDicom(head)) {
            dicomFiles_.push_back(entry);
        } else if (!isHidden(entry) && isCompressedDicom(entry, head)) {
            takeCompressed(entry);
        } else if (!isHidden(entry) && (hasDicomName(entry) || isBlankStub(head, kMagicEnd))) {
            refuse(entry, "is empty, or named like a DICOM file but none: a slice may be damaged",
                   kGetOrRemove);
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
    std::vector<DicomFault> damaged_;
    std::size_t oddEntries_ = 0;  ///< pipes, devices, link loops, links to folders
    std::size_t compressedCopies_ = 0;
    std::size_t entries_ = 0;
};

/// Sorts one file's header into `input`.
void takeHeader(const fs::path& path, DicomHeader header, DicomInput& input) {
    if (header.pixelData || header.hasFloatPixelData) {
        input.files.push_back({path, std::move(header)});
    } else if (isOtherThanImage(header)) {
        ++input.otherFiles;
    } else {
        refuse(path, "is a DICOM image without pixel data, a slice may be cut off", kGetOrRemove);
    }
}

DicomInput readHeaders(const std::vector<fs::path>& paths, DamagedFiles damaged,
                       bool keepsDescription) {
    DicomInput input;
    for (const fs::path& path : paths) {
        try {
            takeHeader(path, readDicomHeader(path, keepsDescription), input);
        } catch (const FileError& error) {
            if (damaged == DamagedFiles::Refuse) throw;
            input.damaged.push_back({path, withoutName(error.what(), path)});
        }
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
        paths.insert(path);
    }
    return {paths.begin(), paths.end()};
}

}  // namespace

bool isGzippedDicom(const fs::path& file) {
    std::string head(132, '\0');
    head.resize(
        ByteSource(file, 0, ByteSource::Encoding::Deflate).readSome(head.data(), head.size()));
    return looksLikeDicom(head);
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
