#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "Common/BatchItems.h"
#include "Common/ChildProcess.h"
#include "Common/Json.h"
#include "Common/KeptFiles.h"

namespace adaptiso {

/// How one run of a batch ended. `toJson` of it is a line of --json.
struct BatchRecord {
    std::string name;
    std::vector<std::string> files;  ///< the inputs, without folders
    int exitCode = 0;
    int signal = 0;                    ///< that ended the run; 0: none
    std::string error;                 ///< one line; empty: none
    std::vector<std::string> outputs;  ///< surfaces written, relative to the item's folder
    double seconds = 0;
    bool isOfEarlierRun = false;
    std::string
        madeAgain{};  ///< why what an earlier run had made did not do; empty: it was not asked
    Json report{};    ///< the run's own; null when there is none
    std::vector<Warning> warnings{};

    bool hasPassed() const { return exitCode == 0 && signal == 0; }
    /// It ran to its end, well or not: nothing would change if it ran again.
    bool isFinished() const { return signal == 0 && (exitCode == 0 || exitCode == 1); }
};

/// The run ended for want of memory, disk or processes, by what it said, or its program could not
/// be started: it may pass at another time or on another machine.
bool mayPassElsewhere(const BatchRecord& record);

Json toJson(const BatchRecord& record, const std::string& program);

/// What the child said, as a record without outputs.
BatchRecord recordOf(const BatchItem& item, const ChildResult& result, const std::string& program);

/// An option that shapes the result. Of its value, which may be a path, only a checksum is kept.
struct KeptOption {
    std::string name;
    std::string sha256;

    friend bool operator==(const KeptOption&, const KeptOption&) = default;
};

struct KeptOutput {
    std::string option;  ///< that names it: "--output", "--report"
    KeptFile file;
};

struct KeptInput {
    KeptFile file;
    /// Its path from the record's folder, of one that lies in the folder of the batch; empty: its
    /// folder's name may be a patient's.
    std::string place;
};

/// What is kept of one surface that a run was to make, or of one run that makes none, in a file of
/// its own: enough to tell whether it would be the same if it were made again.
struct KeptRecord {
    std::string program;
    std::string version;  ///< of the program and the libraries that it stands on
    bool hasEnded = false;
    BatchRecord run{};
    std::string says{};  ///< the result, in words
    std::string date{};  ///< of the end, or of the beginning when there is none yet: UTC, ISO 8601
    Json asked{};        ///< BatchProgram::asked
    std::vector<KeptOption> options{};
    std::vector<KeptInput> inputs{};
    std::vector<KeptOutput> outputs{};
};

/// Why there is no record in a file.
enum class RecordFault { None, Missing, Damaged, OfAnotherVersion };

/// "<file>.<program>.json" beside `file`; where that can't be, as it lies in another folder or its
/// name is too long, the same with a checksum of its path, in `folder`.
std::filesystem::path recordFile(const std::filesystem::path& folder,
                                 const std::filesystem::path& file, const std::string& program);

/// Whether a file's name is that of a record.
bool isRecordFile(const std::filesystem::path& file);

/// The record that a file holds, or why it holds none. Throws nothing, whatever it holds.
std::optional<KeptRecord> readRecord(const std::filesystem::path& file, RecordFault& fault);

/// Writes the record, whole or not at all. \throws FileError
void writeRecord(const std::filesystem::path& file, const KeptRecord& record);

/// Now, as records have it.
std::string recordDate();

}  // namespace adaptiso
