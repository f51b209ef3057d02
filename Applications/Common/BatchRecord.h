#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "Common/BatchItems.h"
#include "Common/ChildProcess.h"
#include "Common/Json.h"

namespace adaptiso {

/// How one run of a batch ended. `toJson` of it is a line of --json and the file that marks the
/// input as finished.
struct BatchRecord {
    std::string name;
    std::vector<std::string> files;  ///< the inputs, without folders
    int exitCode = 0;
    int signal = 0;                    ///< that ended the run; 0: none
    std::string error;                 ///< one line; empty: none
    std::vector<std::string> outputs;  ///< files written, relative to the item's folder
    double seconds = 0;
    bool isOfEarlierRun = false;
    Json report;  ///< the run's own; null when there is none

    bool hasPassed() const { return exitCode == 0 && signal == 0; }
    /// It ran to its end, well or not: nothing would change if it ran again.
    bool isFinished() const { return signal == 0 && (exitCode == 0 || exitCode == 1); }
};

Json toJson(const BatchRecord& record, const std::string& program);

/// What the child said, as a record without outputs.
BatchRecord recordOf(const BatchItem& item, const ChildResult& result, const std::string& program);

/// Where the record of an item is kept: "<folder>/<name>.<program>.json".
std::filesystem::path recordFile(const BatchItem& item, const std::string& program);

/// 16 hexadecimal digits that change with the program's version, the options, and the place, size
/// or time of change of an input (of a folder: of every file in it). Nothing can be read from them.
std::string fingerprint(const BatchItem& item, const std::vector<std::string>& arguments,
                        const std::string& program);

/// The record kept for an item, if its fingerprint is the one given and the files that it names as
/// outputs are there. Anything else, also what is no record, is none.
std::optional<BatchRecord> readRecord(const BatchItem& item, const std::string& program,
                                      const std::string& fingerprint);

/// Keeps a finished record, whole or not at all. \throws FileError
void keepRecord(const BatchItem& item, const BatchRecord& record, const std::string& program,
                const std::string& fingerprint);

}  // namespace adaptiso
