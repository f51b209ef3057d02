#include "Common/BatchRecord.h"

#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <string_view>

#include "Common/CommonOptions.h"
#include "Common/Log.h"
#include "Common/RunApp.h"
#include "Common/Sha256.h"
#include "Common/Verdict.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/ParseJson.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Core/TextLines.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

bool isHidden(const fs::path& path) {
    const std::string name = path.filename().native();
    return name.starts_with('.') && name != ".zarray" && name != ".zattrs" && name != ".zgroup";
}

std::vector<fs::path> filesIn(const fs::path& folder, const fs::path& output, bool isDeep) {
    std::vector<fs::path> files;
    std::error_code error, ignored;
    const fs::path excluded = output.empty() ? fs::path() : fs::weakly_canonical(output, ignored);
    fs::recursive_directory_iterator entry(folder, error);
    for (const fs::recursive_directory_iterator end; !error && entry != end;
         entry.increment(error)) {
        const fs::path& path = entry->path();
        if (entry->is_directory(ignored)) {
            const bool isOutput =
                !excluded.empty() && fs::weakly_canonical(path, ignored) == excluded;
            if (!isDeep || isOutput || isHidden(path)) entry.disable_recursion_pending();
        } else if (entry->is_regular_file(ignored) && !isHidden(path) &&
                   (!entry->is_symlink(ignored) || liesIn(path, folder))) {
            files.push_back(path);
        }
    }
    std::sort(files.begin(), files.end());
    return files;
}

/// The value of a line "ElementDataFile = x" (MetaImage) or "data file: x" (NRRD); may be empty.
std::string dataFileOf(const fs::path& file) {
    constexpr std::size_t kLongest = std::size_t{1} << 16;
    std::string header(kLongest, '\0');
    std::ifstream in(file, std::ios::binary);
    in.read(header.data(), static_cast<std::streamsize>(header.size()));
    header.resize(static_cast<std::size_t>(in.gcount()));
    const bool isNrrd = withoutByteOrderMark(header).starts_with("NRRD");
    if (!isNrrd && header.find("ElementDataFile") == std::string::npos) return {};
    TextLines lines(header, LineEnds::OfFirst);
    while (const auto line = lines.next()) {
        if (trimmed(*line).empty()) break;
        const std::size_t sign = line->find(isNrrd ? ':' : '=');
        if (sign == std::string::npos) continue;
        const std::string key = lowerCase(trimmed(line->substr(0, sign)));
        if (key == "elementdatafile" || key == "data file" || key == "datafile") {
            return std::string(trimmed(line->substr(sign + 1)));
        }
    }
    return {};
}

/// "scan" for "scan.hdr" and "scan.img.gz"; empty for other files.
std::string pairStem(const fs::path& path) {
    const std::string name = path.filename().string(), lower = lowerCase(name);
    for (const std::string_view ending : {".hdr", ".img", ".hdr.gz", ".img.gz"}) {
        if (lower.ends_with(ending)) return name.substr(0, name.size() - ending.size());
    }
    return {};
}

std::vector<fs::path> belongingTo(const fs::path& input, const fs::path& output) {
    const fs::path folder = detail::folderOf(input);
    if (lowerCase(input.filename().string()) == "dicomdir") return filesIn(folder, output, true);
    if (const std::string stem = pairStem(input); !stem.empty()) {
        std::vector<fs::path> files = filesIn(folder, {}, false);
        std::erase_if(files, [&](const fs::path& file) { return pairStem(file) != stem; });
        return files;
    }
    const std::string data = dataFileOf(input);
    if (!staysBelow(data) || data == "LOCAL") return {};
    std::error_code error;
    if (fs::is_regular_file(folder / data, error)) {
        if (!liesBeside(folder / data, input)) return {};  // which reading refuses
        return {folder / data};
    }
    return filesIn(folder, output, true);  // a list or a pattern of files
}

void addTimes(RecordedFile& file, const fs::path& path) {
    struct stat status {};
    if (stat(path.c_str(), &status) != 0) {
        throw FileError(path.string() + ": can't be read: " + detail::reason());
    }
    // a pipe or a device may have no end
    if (!S_ISREG(status.st_mode)) throw FileError(path.string() + ": is no regular file");
    const auto nanoseconds = [](const timespec& time) {
        constexpr std::int64_t kPerSecond = 1'000'000'000;
        return std::int64_t{time.tv_sec} * kPerSecond + time.tv_nsec;
    };
    file.bytes += static_cast<std::uint64_t>(status.st_size);
    file.modifiedNs = std::max(file.modifiedNs, nanoseconds(status.st_mtim));
    file.changedNs = std::max(file.changedNs, nanoseconds(status.st_ctim));
}

Json toJson(const RecordedFile& file) {
    Json json{{"file", file.file},
              {"bytes", file.bytes},
              {"sha256", file.sha256},
              {"modifiedNs", file.modifiedNs},
              {"changedNs", file.changedNs}};
    if (file.files != 1) json["files"] = file.files;
    if (!file.option.empty()) json["option"] = file.option;
    if (!file.place.empty()) json["place"] = file.place;
    return json;
}

/// The first line of a child's stderr, without the program's name and the inputs' folders.
std::string errorLine(const std::string& errors, const std::vector<fs::path>& inputs,
                      const std::string& program) {
    std::string line = errors.substr(0, errors.find('\n'));
    const auto leaveOut = [&line](const std::string& start) {
        if (line.starts_with(start)) line.erase(0, start.size());
    };
    leaveOut(program + ": ");
    if (!inputs.empty()) leaveOut(inputs.front().string() + ": ");
    for (const fs::path& input : inputs) {
        const std::string path = input.string(), name = baseName(input);
        if (path.find('/') == std::string::npos) continue;  // "." is in every sentence
        for (std::size_t at = line.find(path); at != std::string::npos;
             at = line.find(path, at + name.size())) {
            line.replace(at, path.size(), name);
        }
    }
    if (!inputs.empty()) leaveOut(baseName(inputs.front()) + ": ");
    return line;
}

}  // namespace

RecordedFile describeFile(const std::string& name, const fs::path& path) {
    RecordedFile file;
    file.file = name;
    addTimes(file, path);  // first: a file that changes while it is read gets other times
    file.sha256 = sha256OfFile(path);
    return file;
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

RecordedFile describeInput(const fs::path& input, const fs::path& output) {
    std::error_code error;
    const bool isFolder = fs::is_directory(input, error);
    const std::vector<fs::path> files = filesOfInput(input, output);
    if (!isFolder && files.size() == 1) return describeFile(baseName(input), input);
    RecordedFile all;
    all.file = baseName(input);
    all.files = files.size();
    std::string list;
    for (const fs::path& file : files) {
        addTimes(all, file);
        list += sha256OfFile(file) + "  " +
                file.lexically_relative(isFolder ? input : detail::folderOf(input)).string() + "\n";
    }
    all.sha256 = sha256Of(list);
    return all;
}

bool hasTimes(const RecordedFile& recorded, const fs::path& input, const fs::path& output) {
    try {
        RecordedFile now;
        const std::vector<fs::path> files = filesOfInput(input, output);
        for (const fs::path& file : files) addTimes(now, file);
        return files.size() == recorded.files && now.bytes == recorded.bytes &&
               now.modifiedNs == recorded.modifiedNs && now.changedNs == recorded.changedNs;
    } catch (const FileError&) {
        return false;
    }
}

bool isSameContent(const RecordedFile& a, const RecordedFile& b) {
    return a.files == b.files && a.bytes == b.bytes && a.sha256 == b.sha256;
}

FileChange changeOf(const RecordedFile& recorded, const fs::path& path) {
    std::error_code error;
    if (!fs::exists(path, error)) return FileChange::Gone;
    try {
        RecordedFile now;
        addTimes(now, path);
        const bool hasTimes =
            now.modifiedNs == recorded.modifiedNs && now.changedNs == recorded.changedNs;
        const bool isSame =
            now.bytes == recorded.bytes && (hasTimes || sha256OfFile(path) == recorded.sha256);
        return isSame ? FileChange::None : FileChange::Changed;
    } catch (const FileError&) {
        return FileChange::Changed;  // can't be read
    }
}

std::string changeText(FileChange change) {
    return change == FileChange::Gone ? "is gone" : "has changed";
}

Json lineJson(const RunRecord& record) {
    Json error = record.report.is_object() ? record.report.value("error", Json()) : Json();
    if (!record.error.empty()) {
        error = {{"text", record.error}};
        if (!record.files.empty()) error["file"] = record.files.front();
    }
    return {
        {"schema", "adaptiso-batch/1"},
        {"program", {{"name", record.program}, {"version", programVersion()}}},
        {"name", record.name},
        {"files", record.files},
        {"passed", record.hasEnded && record.hasPassed()},
        {"exitCode", record.hasEnded && record.signal == 0 ? Json(record.exitCode) : Json(nullptr)},
        {"signal", record.signal != 0 ? Json(record.signal) : Json(nullptr)},
        {"error", std::move(error)},
        {"warnings", record.warnings},
        {"earlierRun", record.isOfEarlierRun},
        {"madeAgain", record.madeAgain.empty() ? Json(nullptr) : Json(record.madeAgain)},
        {"outputs", record.outputs},
        {"seconds", number(record.seconds)},
        {"report", record.report}};
}

void addResult(const ChildResult& result, const std::vector<fs::path>& inputs, RunRecord& record) {
    constexpr int kNotStarted = 127, kNotExecutable = 126;
    record.hasEnded = true;
    record.exitCode = result.exitCode;
    record.signal = result.signal;
    record.seconds = result.seconds;
    record.wasShort =
        result.signal != 0 || result.exitCode == kNotStarted || result.exitCode == kNotExecutable;
    Json report = parseJson<Json>(result.output);
    if (report.is_object()) {
        record.warnings = report.value("warnings", std::vector<Warning>());
        record.wasShort = record.wasShort || report.value("shortage", false);
        // a failure's report holds no more than stderr
        if (report.value("schema", "") != kFailureSchema) record.report = std::move(report);
    }
    if (result.signal != 0) {
        record.error = std::string("ended by a signal: ") + strsignal(result.signal);
    } else if (!record.isFinished()) {
        record.error = errorLine(result.errors, inputs, record.program);
        if (record.error.empty()) {
            record.error = "ended with exit code " + std::to_string(result.exitCode);
        }
    }
}

fs::path recordFile(const fs::path& folder, const fs::path& file, const std::string& program) {
    constexpr std::size_t kLongestName = 255, kDigits = 12;
    const std::string ending = "." + program + ".json", name = file.filename().string();
    const fs::path inFolder = fs::absolute(file).lexically_normal().lexically_relative(
        fs::absolute(folder.empty() ? fs::path(".") : folder / "").lexically_normal());
    if (inFolder == file.filename() && name.size() + ending.size() <= kLongestName) {
        return (folder / (name + ending)).lexically_normal();
    }
    const std::string sum = "." + sha256Of(inFolder.generic_string()).substr(0, kDigits);
    const std::size_t room = kLongestName - ending.size() - sum.size();
    return (folder / (name.substr(0, room) + sum + ending)).lexically_normal();
}

std::vector<fs::path> recordFiles(const fs::path& folder, bool hasSubjects) {
    const fs::path root = folder.empty() ? fs::path(".") : folder;
    std::vector<fs::path> found;
    std::error_code error, ignored;
    fs::recursive_directory_iterator entry(root, error);
    for (const fs::recursive_directory_iterator end; !error && entry != end;
         entry.increment(error)) {
        const std::string name = entry->path().filename().native();
        if (entry->is_directory(ignored)) {
            const bool isSubject = entry.depth() > 0 || name.starts_with("sub-");
            if (!hasSubjects || !isSubject || name.starts_with('.')) {
                entry.disable_recursion_pending();
            }
        } else if (!name.starts_with(".adaptiso-") && name.ends_with(".json") &&
                   name.find(".adaptiso-") != std::string::npos) {
            found.push_back(entry->path().lexically_normal());
        }
    }
    std::sort(found.begin(), found.end());
    return found;
}

void writeRecord(const fs::path& file, const RunRecord& record) {
    Json json = lineJson(record);
    json["schema"] = kRecordSchema;
    json["build"] = record.version;
    json["ended"] = record.hasEnded;
    json["date"] = record.date;
    json["says"] = record.says;
    if (!record.request.is_null()) json["asked"] = record.request;
    json["options"] = json["inputs"] = json["keptOutputs"] = Json::array();
    for (const RecordedOption& option : record.options) {
        json["options"].push_back({{"name", option.name}, {"sha256", option.sha256}});
    }
    for (const RecordedFile& input : record.inputs) json["inputs"].push_back(toJson(input));
    for (const RecordedFile& output : record.recordedOutputs) {
        json["keptOutputs"].push_back(toJson(output));
    }
    writeWhole(file, jsonText(json) + "\n", detail::folderOf(file));
}

std::string recordDate() {
    return utcDate();
}

void writeWhole(const fs::path& file, const std::string& text, const fs::path& ownFolder) {
    AtomicOutput output(file, ownFolder);
    output.writeText(text);
    AtomicOutput::commit({&output, 1});
}

}  // namespace adaptiso
