#include "Common/KeptFiles.h"

#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <sstream>
#include <string_view>

#include "Common/AtomicOutput.h"
#include "Common/Sha256.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

std::int64_t nanoseconds(const timespec& time) {
    constexpr std::int64_t kPerSecond = 1'000'000'000;
    return std::int64_t{time.tv_sec} * kPerSecond + time.tv_nsec;
}

/// Skips hidden files, except Zarr's metadata.
bool isHidden(const fs::path& path) {
    const std::string name = path.filename().native();
    return name.starts_with('.') && name != ".zarray" && name != ".zattrs" && name != ".zgroup";
}

/// The regular files of a folder, by name. \param isDeep  those of its folders too
std::vector<fs::path> filesIn(const fs::path& folder, const fs::path& output, bool isDeep) {
    std::vector<fs::path> files;
    std::error_code error, ignored;
    const fs::path excluded = output.empty() ? fs::path() : fs::weakly_canonical(output, ignored);
    fs::recursive_directory_iterator entry(folder, error);
    for (const fs::recursive_directory_iterator end; !error && entry != end;
         entry.increment(error)) {
        if (entry->is_directory(ignored)) {
            const bool isOutput =
                !excluded.empty() && fs::weakly_canonical(entry->path(), ignored) == excluded;
            if (!isDeep || isOutput || isHidden(entry->path())) entry.disable_recursion_pending();
        } else if (entry->is_regular_file(ignored) && !isHidden(entry->path())) {
            files.push_back(entry->path());
        }
    }
    std::sort(files.begin(), files.end());
    return files;
}

/// As far as a text at its beginning may reach.
std::string headerText(const fs::path& file) {
    constexpr std::size_t kLongest = std::size_t{1} << 16;
    std::string text(kLongest, '\0');
    std::ifstream in(file, std::ios::binary);
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(in.gcount()));
    return text;
}

/// The value of a line "ElementDataFile = x" (MetaImage) or "data file: x" (NRRD); empty: none.
std::string dataFileOf(const std::string& header) {
    const bool isNrrd = header.starts_with("NRRD");
    if (!isNrrd && header.find("ElementDataFile") == std::string::npos) return {};
    std::istringstream lines(header);
    for (std::string line; std::getline(lines, line) && !trimmed(line).empty();) {
        const std::size_t sign = line.find(isNrrd ? ':' : '=');
        if (sign == std::string::npos) continue;
        const std::string key = lowerCase(trimmed(std::string_view(line).substr(0, sign)));
        if (key == "elementdatafile" || key == "data file" || key == "datafile") {
            return std::string(trimmed(std::string_view(line).substr(sign + 1)));
        }
    }
    return {};
}

/// "scan.img" and its like, of "scan.hdr", and the reverse.
std::vector<fs::path> companions(const fs::path& input) {
    std::vector<fs::path> found;
    const auto stemOf = [](const fs::path& path) {
        const std::string name = path.filename().string();
        const std::string lower = lowerCase(name);
        for (const std::string_view ending : {".hdr", ".img", ".hdr.gz", ".img.gz"}) {
            if (lower.ends_with(ending)) return name.substr(0, name.size() - ending.size());
        }
        return std::string();
    };
    const std::string stem = stemOf(input);
    if (stem.empty()) return found;
    for (const fs::path& file : filesIn(detail::folderOf(input), {}, false)) {
        if (stemOf(file) == stem) found.push_back(file);
    }
    return found;
}

std::vector<fs::path> belongingTo(const fs::path& input, const fs::path& output) {
    const fs::path folder = detail::folderOf(input);
    if (lowerCase(input.filename().string()) == "dicomdir") return filesIn(folder, output, true);
    std::vector<fs::path> files = companions(input);
    if (!files.empty()) return files;
    const std::string data = dataFileOf(headerText(input));
    if (data.empty() || data == "LOCAL") return {};
    std::error_code error;
    if (fs::is_regular_file(folder / data, error)) return {folder / data};
    return filesIn(folder, output, true);  // a list or a pattern of files
}

void addTimes(KeptFile& kept, const fs::path& path) {
    struct stat status {};
    if (stat(path.c_str(), &status) != 0) {
        throw FileError(path.string() + ": can't be read: " + detail::reason());
    }
    // a pipe or a device may have no end
    if (!S_ISREG(status.st_mode)) throw FileError(path.string() + ": is no regular file");
    kept.bytes += static_cast<std::uint64_t>(status.st_size);
    kept.modifiedNs = std::max(kept.modifiedNs, nanoseconds(status.st_mtim));
    kept.changedNs = std::max(kept.changedNs, nanoseconds(status.st_ctim));
}

}  // namespace

KeptFile keptFile(const std::string& name, const fs::path& path) {
    KeptFile kept;
    kept.file = name;
    addTimes(kept, path);  // first: what changes while it is read has other times
    kept.sha256 = sha256OfFile(path);
    return kept;
}

std::vector<fs::path> filesOfInput(const fs::path& input, const fs::path& output) {
    std::error_code error;
    if (fs::is_directory(input, error)) return filesIn(input, output, true);
    std::vector<fs::path> files{input};
    if (!fs::is_regular_file(input, error)) return files;
    for (fs::path& file : belongingTo(input, output)) {
        if (!fs::equivalent(file, input, error)) files.push_back(std::move(file));
    }
    return files;
}

KeptFile keptInput(const fs::path& input, const fs::path& output) {
    std::error_code error;
    const bool isFolder = fs::is_directory(input, error);
    const std::vector<fs::path> files = filesOfInput(input, output);
    if (!isFolder && files.size() == 1) return keptFile(baseName(input), input);
    KeptFile kept;
    kept.file = baseName(input);
    kept.files = files.size();
    const fs::path folder = isFolder ? input : detail::folderOf(input);
    std::string list;
    for (const fs::path& file : files) {
        addTimes(kept, file);
        list += sha256OfFile(file) + "  " + file.lexically_relative(folder).string() + "\n";
    }
    kept.sha256 = sha256Of(list);
    return kept;
}

bool hasTimesOf(const KeptFile& kept, const fs::path& input, const fs::path& output) {
    KeptFile now;
    try {
        const std::vector<fs::path> files = filesOfInput(input, output);
        now.files = files.size();
        for (const fs::path& file : files) addTimes(now, file);
    } catch (const FileError&) {
        return false;
    }
    return now.files == kept.files && now.bytes == kept.bytes &&
           now.modifiedNs == kept.modifiedNs && now.changedNs == kept.changedNs;
}

FileChange changeOf(const KeptFile& kept, const KeptFile& now) {
    const bool isSame =
        kept.files == now.files && kept.bytes == now.bytes && kept.sha256 == now.sha256;
    return isSame ? FileChange::None : FileChange::Changed;
}

FileChange changeOf(const KeptFile& kept, const fs::path& path, bool trustsTimes) {
    std::error_code error;
    if (!fs::exists(path, error)) return FileChange::Gone;
    KeptFile now;
    try {
        addTimes(now, path);
        if (!fs::is_regular_file(path, error) || now.bytes != kept.bytes) {
            return FileChange::Changed;
        }
        const bool hasTimes = now.modifiedNs == kept.modifiedNs && now.changedNs == kept.changedNs;
        if (trustsTimes && hasTimes) return FileChange::None;
        now.sha256 = sha256OfFile(path);
    } catch (const FileError&) {
        return FileChange::Changed;  // can't be read
    }
    return changeOf(kept, now);
}

Json toJson(const KeptFile& file) {
    Json json{{"file", file.file}, {"bytes", file.bytes}, {"sha256", file.sha256}};
    if (file.files != 1) json["files"] = file.files;
    json["modifiedNs"] = file.modifiedNs;
    json["changedNs"] = file.changedNs;
    return json;
}

KeptFile keptFileOf(const Json& json) {
    KeptFile file;
    file.file = json.at("file").get<std::string>();
    file.files = json.value("files", std::uint64_t{1});
    file.bytes = json.at("bytes").get<std::uint64_t>();
    file.sha256 = json.at("sha256").get<std::string>();
    file.modifiedNs = json.at("modifiedNs").get<std::int64_t>();
    file.changedNs = json.at("changedNs").get<std::int64_t>();
    return file;
}

}  // namespace adaptiso
