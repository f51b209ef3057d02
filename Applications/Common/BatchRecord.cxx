#include "Common/BatchRecord.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <fstream>
#include <string_view>

#include "Common/AtomicOutput.h"
#include "Common/CommonOptions.h"
#include "Common/RunApp.h"
#include "Common/Sha256.h"
#include "Common/Verdict.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLineSchema = "adaptiso-batch/1";
constexpr const char* kRecordSchema = "adaptiso-record/1";
constexpr std::string_view kRecordMark = ".adaptiso-", kRecordEnding = ".json";

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

Json recordJson(const KeptRecord& record) {
    Json json = toJson(record.run, record.program);
    json["schema"] = kRecordSchema;
    json["build"] = record.version;
    json["ended"] = record.hasEnded;
    json["date"] = record.date;
    json["says"] = record.says;
    if (!record.asked.is_null()) json["asked"] = record.asked;
    Json options = Json::array(), inputs = Json::array(), outputs = Json::array();
    for (const KeptOption& option : record.options) {
        options.push_back({{"name", option.name}, {"sha256", option.sha256}});
    }
    for (const KeptInput& input : record.inputs) {
        Json kept = toJson(input.file);
        if (!input.place.empty()) kept["place"] = input.place;
        inputs.push_back(std::move(kept));
    }
    for (const KeptOutput& output : record.outputs) {
        Json kept = toJson(output.file);
        kept["option"] = output.option;
        outputs.push_back(std::move(kept));
    }
    json["options"] = std::move(options);
    json["inputs"] = std::move(inputs);
    json["keptOutputs"] = std::move(outputs);
    return json;
}

/// \throws Json::exception  a key is missing, or its value of another type
KeptRecord recordFrom(const Json& json) {
    KeptRecord record;
    record.program = json.at("program").at("name").get<std::string>();
    record.version = json.at("build").get<std::string>();
    record.hasEnded = json.at("ended").get<bool>();
    record.date = json.at("date").get<std::string>();
    record.says = json.at("says").get<std::string>();
    if (json.contains("asked")) record.asked = json["asked"];
    BatchRecord& run = record.run;
    run.name = json.at("name").get<std::string>();
    run.files = json.at("files").get<std::vector<std::string>>();
    if (!json.at("exitCode").is_null()) run.exitCode = json.at("exitCode").get<int>();
    if (!json.at("signal").is_null()) run.signal = json.at("signal").get<int>();
    if (!run.isFinished() && json.at("error").is_object()) {
        run.error = json["error"].at("text").get<std::string>();
    }
    run.warnings = json.at("warnings").get<std::vector<Warning>>();
    run.outputs = json.at("outputs").get<std::vector<std::string>>();
    run.seconds = json.at("seconds").get<double>();
    run.report = json.at("report");
    for (const Json& option : json.at("options")) {
        record.options.push_back(
            {option.at("name").get<std::string>(), option.at("sha256").get<std::string>()});
    }
    for (const Json& input : json.at("inputs")) {
        record.inputs.push_back({keptFileOf(input), input.value("place", std::string())});
    }
    for (const Json& output : json.at("keptOutputs")) {
        record.outputs.push_back({output.at("option").get<std::string>(), keptFileOf(output)});
    }
    return record;
}

/// {text, file}; of a run that went to its end, that of its own report.
Json errorJson(const BatchRecord& record) {
    if (!record.error.empty()) {
        Json json{{"text", record.error}};
        if (!record.files.empty()) json["file"] = record.files.front();
        return json;
    }
    return record.report.is_object() ? record.report.value("error", Json()) : Json();
}

}  // namespace

Json toJson(const BatchRecord& record, const std::string& program) {
    return {{"schema", kLineSchema},
            {"program", {{"name", program}, {"version", programVersion()}}},
            {"name", record.name},
            {"files", record.files},
            {"passed", record.hasPassed()},
            {"exitCode", record.signal == 0 ? Json(record.exitCode) : Json(nullptr)},
            {"signal", record.signal != 0 ? Json(record.signal) : Json(nullptr)},
            {"error", errorJson(record)},
            {"warnings", record.warnings},
            {"earlierRun", record.isOfEarlierRun},
            {"madeAgain", record.madeAgain.empty() ? Json(nullptr) : Json(record.madeAgain)},
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
    if (!record.report.is_object()) record.report = nullptr;
    if (record.report.is_object() && record.report.contains("warnings")) {
        record.warnings = record.report["warnings"].get<std::vector<Warning>>();
    }
    // its error is on stderr, too
    if (record.report.is_object() && record.report.value("schema", "") == kFailureSchema) {
        record.report = nullptr;
    }
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

bool mayPassElsewhere(const BatchRecord& record) {
    constexpr int kNotStarted = 127, kNotExecutable = 126;
    if (record.signal != 0 || record.exitCode == kNotStarted || record.exitCode == kNotExecutable) {
        return true;
    }
    if (record.exitCode != kExitBadInput) return false;
    // exit code 3 is for bad input, too; the texts are RunApp's, ImageIO's, and the system's
    const std::string_view texts[] = {"not enough memory", "memory, more than there is",
                                      "needs more memory", "out of memory",
                                      "a thread or process could not be started"};
    const auto isSaid = [&](std::string_view text) {
        return record.error.find(text) != std::string::npos;
    };
    return std::ranges::any_of(texts, isSaid) ||
           std::ranges::any_of(std::array{ENOSPC, EDQUOT, ENOMEM, EIO, ESTALE, EMFILE, ENFILE},
                               [&](int number) { return isSaid(std::strerror(number)); });
}

fs::path recordFile(const fs::path& folder, const fs::path& file, const std::string& program) {
    constexpr std::size_t kLongestName = 255;
    constexpr std::size_t kDigits = 12;
    const std::string ending = "." + program + std::string(kRecordEnding);
    const std::string name = file.filename().string();
    const fs::path inFolder = fs::absolute(file).lexically_normal().lexically_relative(
        fs::absolute(folder.empty() ? fs::path(".") : folder / "").lexically_normal());
    if (inFolder == file.filename() && name.size() + ending.size() <= kLongestName) {
        return (folder / (name + ending)).lexically_normal();
    }
    const std::string sum = "." + sha256Of(inFolder.generic_string()).substr(0, kDigits);
    const std::size_t room = kLongestName - ending.size() - sum.size();
    return (folder / (name.substr(0, room) + sum + ending)).lexically_normal();
}

bool isRecordFile(const fs::path& file) {
    const std::string name = file.filename().string();
    return !name.starts_with(".") && name.ends_with(kRecordEnding) &&
           name.rfind(kRecordMark) != std::string::npos;
}

std::optional<KeptRecord> readRecord(const fs::path& path, RecordFault& fault) {
    std::ifstream file(path);
    fault = RecordFault::Missing;
    if (!file) return std::nullopt;
    fault = RecordFault::Damaged;
    try {
        const Json json = Json::parse(file);
        if (json.at("schema") != kRecordSchema) {
            fault = RecordFault::OfAnotherVersion;
            return std::nullopt;
        }
        KeptRecord record = recordFrom(json);
        fault = RecordFault::None;
        return record;
    } catch (const Json::exception&) {
        return std::nullopt;  // no record of ours, or one cut off by hand
    }
}

void writeRecord(const fs::path& file, const KeptRecord& record) {
    std::vector<AtomicOutput> outputs;
    outputs.emplace_back(file).writeText(jsonText(recordJson(record)) + "\n");
    AtomicOutput::commit(outputs);
}

std::string recordDate() {
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    gmtime_r(&now, &utc);
    std::array<char, 32> text{};
    const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc);
    return {text.data(), length};
}

}  // namespace adaptiso
