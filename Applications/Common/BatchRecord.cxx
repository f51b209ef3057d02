#include "Common/BatchRecord.h"

#include <sys/stat.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>

#include "Common/AtomicOutput.h"
#include "Common/CommonOptions.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSchema = "adaptiso-batch/1";

/// FNV-1a of 64 bits over texts and what is known of files.
class Hash {
public:
    void add(const std::string& text) {
        for (const char c : text) add(static_cast<unsigned char>(c));
        add('\0');
    }
    /// Path, size and time of change; a file that is not there is one of size 0.
    void addFile(const fs::path& path) {
        struct stat status {};
        stat(path.c_str(), &status);
        add(path.string() + " " + std::to_string(status.st_size) + " " +
            std::to_string(status.st_mtim.tv_sec) + " " + std::to_string(status.st_mtim.tv_nsec));
    }
    std::string text() const {
        std::ostringstream out;
        out << std::hex;
        out.width(16);
        out.fill('0');
        out << state_;
        return out.str();
    }

private:
    void add(unsigned char byte) {
        constexpr std::uint64_t kPrime = 0x100000001b3;
        state_ = (state_ ^ byte) * kPrime;
    }
    std::uint64_t state_ = 0xcbf29ce484222325;
};

/// The files of a DICOM folder, in no order of the file system's.
std::vector<fs::path> filesIn(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::recursive_directory_iterator(folder, error)) {
        files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

/// What a child wrote on stderr as one line, without what the reader of a batch's line knows or
/// should not: the program's and the input's name, the advice after a wrong usage, the inputs'
/// folders.
std::string errorLine(const BatchItem& item, const std::string& errors,
                      const std::string& program) {
    std::string line = errors.substr(0, errors.find('\n'));
    const auto leaveOut = [&line](const std::string& start) {
        if (line.starts_with(start)) line.erase(0, start.size());
    };
    leaveOut(program + ": ");
    for (const fs::path& input : item.inputs) {
        const std::string path = input.string();
        const std::string name = baseName(input);
        for (std::size_t at = line.find(path); at != std::string::npos;
             at = line.find(path, at + name.size())) {
            line.replace(at, path.size(), name);
        }
    }
    leaveOut(baseName(item.inputs.front()) + ": ");
    return line;
}

}  // namespace

Json toJson(const BatchRecord& record, const std::string& program) {
    return {{"schema", kSchema},
            {"program", {{"name", program}, {"version", programVersion()}}},
            {"name", record.name},
            {"files", record.files},
            {"passed", record.hasPassed()},
            {"exitCode", record.signal == 0 ? Json(record.exitCode) : Json(nullptr)},
            {"signal", record.signal != 0 ? Json(record.signal) : Json(nullptr)},
            {"error", record.error.empty() ? Json(nullptr) : Json(record.error)},
            {"earlierRun", record.isOfEarlierRun},
            {"outputs", record.outputs},
            {"seconds", number(record.seconds)},
            {"report", record.report}};
}

BatchRecord recordOf(const BatchItem& item, const ChildResult& result, const std::string& program) {
    BatchRecord record;
    record.name = item.name;
    for (const fs::path& input : item.inputs) record.files.push_back(baseName(input));
    record.exitCode = result.exitCode;
    record.signal = result.signal;
    record.seconds = result.seconds;
    record.report = Json::parse(result.output, nullptr, false);
    if (record.report.is_discarded()) record.report = nullptr;
    if (result.signal != 0) {
        record.error = std::string("ended by a signal: ") + strsignal(result.signal);
    } else if (!record.isFinished()) {
        record.error = errorLine(item, result.errors, program);
        if (record.error.empty()) {
            record.error = "ended with exit code " + std::to_string(result.exitCode);
        }
    }
    return record;
}

fs::path recordFile(const BatchItem& item, const std::string& program) {
    return item.folder / (item.name + "." + program + ".json");
}

std::string fingerprint(const BatchItem& item, const std::vector<std::string>& arguments,
                        const std::string& program) {
    Hash hash;
    hash.add(versionText(program));
    for (const std::string& argument : arguments) hash.add(argument);
    for (const fs::path& input : item.inputs) {
        hash.addFile(input);
        std::error_code error;
        if (!fs::is_directory(input, error)) continue;
        for (const fs::path& file : filesIn(input)) hash.addFile(file);
    }
    return hash.text();
}

std::optional<BatchRecord> readRecord(const BatchItem& item, const std::string& program,
                                      const std::string& fingerprint) {
    std::ifstream file(recordFile(item, program));
    if (!file) return std::nullopt;
    const Json json = Json::parse(file, nullptr, false);
    try {
        if (json.at("schema") != kSchema || json.at("fingerprint") != fingerprint) {
            return std::nullopt;
        }
        BatchRecord record;
        record.name = json.at("name");
        record.files = json.at("files");
        record.exitCode = json.at("exitCode");
        record.outputs = json.at("outputs");
        record.seconds = json.at("seconds");
        record.report = json.at("report");
        record.isOfEarlierRun = true;
        for (const std::string& output : record.outputs) {
            if (!fs::exists(item.folder / output)) return std::nullopt;
        }
        return record;
    } catch (const Json::exception&) {
        return std::nullopt;  // no record of ours, or one cut off by hand
    }
}

void keepRecord(const BatchItem& item, const BatchRecord& record, const std::string& program,
                const std::string& fingerprint) {
    Json json = toJson(record, program);
    json["fingerprint"] = fingerprint;
    std::vector<AtomicOutput> outputs;
    outputs.emplace_back(recordFile(item, program))
        .writeText(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
    AtomicOutput::commit(outputs);
}

}  // namespace adaptiso
