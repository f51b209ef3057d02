#include <set>

#include "Common/BatchRecord.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/ParseJson.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

std::vector<RecordedFile> filesFrom(const Json& list) {
    std::vector<RecordedFile> files;
    for (const Json& json : list) {
        RecordedFile file;
        file.file = json.at("file");
        if (json.contains("files")) file.files = wholeNumber<std::uint64_t>(json["files"]);
        file.bytes = wholeNumber<std::uint64_t>(json.at("bytes"));
        file.sha256 = json.at("sha256");
        file.modifiedNs = wholeNumber<std::int64_t>(json.at("modifiedNs"));
        file.changedNs = wholeNumber<std::int64_t>(json.at("changedNs"));
        file.option = json.value("option", "");
        file.place = json.value("place", "");
        files.push_back(std::move(file));
    }
    return files;
}

/// A record must not lead to files elsewhere.
/// \param folder  the record's \throws FileError
void requirePlaces(const RunRecord& record, const fs::path& folder) {
    const auto require = [&](const std::string& place) {
        if (!staysBelow(place)) throw FileError("it names a file outside its folder");
        if (withoutControls(place) != place || place.find("{name}") != std::string::npos) {
            throw FileError("it names a file as no program does");
        }
        requireIn(folder / place, folder);
    };
    std::set<std::string> known;
    for (const std::string& output : record.outputs) {
        require(output);
        if (!known.insert(output).second) throw FileError("it names a file twice");
    }
    for (const RecordedFile& output : record.recordedOutputs) require(output.file);
    for (const RecordedFile& input : record.inputs) {
        if (!input.place.empty()) require(input.place);
    }
}

/// The request of adaptiso-bids, as its group level takes it.
/// \throws Json::exception  a value has another type  \throws FileError  it is no such request
void requireRequest(const Json& request) {
    if (!request.is_object()) throw FileError("its request is no object");
    for (const char* key : {"product", "options", "segmentations"}) {
        static_cast<void>(request.value(key, std::string()));
    }
    for (const char* key : {"pictures", "strict"}) static_cast<void>(request.value(key, false));
    for (const std::string& code : request.value("allow", std::vector<std::string>())) {
        if (code.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") != std::string::npos) {
            throw FileError("it allows what is no warning's code");
        }
    }
}

/// \throws Json::exception  a key is missing, or its value has another type
/// \throws FileError        as requireRequest()
RunRecord recordFrom(const Json& json) {
    RunRecord record;
    record.program = json.at("program").at("name");
    record.version = json.at("build");
    record.hasEnded = json.at("ended");
    record.date = json.at("date");
    record.says = json.at("says");
    record.request = json.value("asked", Json());
    if (!record.request.is_null()) requireRequest(record.request);
    record.name = json.at("name");
    record.files = json.at("files").get<std::vector<std::string>>();
    if (!json.at("exitCode").is_null()) record.exitCode = wholeNumber<int>(json.at("exitCode"));
    if (!json.at("signal").is_null()) record.signal = wholeNumber<int>(json.at("signal"));
    if (!record.isFinished() && json.at("error").is_object()) {
        record.error = json["error"].at("text");
    }
    record.warnings = json.at("warnings").get<std::vector<Warning>>();
    record.outputs = json.at("outputs").get<std::vector<std::string>>();
    record.seconds = json.at("seconds");
    record.report = json.at("report");
    for (const Json& option : json.at("options")) {
        record.options.push_back({option.at("name"), option.at("sha256")});
    }
    record.inputs = filesFrom(json.at("inputs"));
    record.recordedOutputs = filesFrom(json.at("keptOutputs"));
    return record;
}

}  // namespace

RecordFault readRecord(const fs::path& path, RunRecord& record) {
    try {
        const fs::path folder = path.parent_path();
        const std::optional<std::string> text = readFoundFile(path, folder);
        if (!text) return RecordFault::Missing;
        const auto json = parseJson<Json>(*text);
        if (json.at("schema") != kRecordSchema) return RecordFault::OfAnotherVersion;
        record = recordFrom(json);
        requirePlaces(record, folder);
        return RecordFault::None;
    } catch (const Json::exception&) {
        return RecordFault::Damaged;  // not one of ours, or edited
    } catch (const FileError&) {
        return RecordFault::Damaged;
    }
}

}  // namespace adaptiso
