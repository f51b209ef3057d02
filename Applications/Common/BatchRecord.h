#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "Common/ChildProcess.h"
#include "Common/Json.h"

namespace adaptiso {

inline constexpr const char* kRecordSchema = "adaptiso-record/1";

/// A file, or several that belong together, as a record describes it.
struct RecordedFile {
    std::string file;  ///< its name, or for an output its path from the record's folder
    std::uint64_t files = 1, bytes = 0;
    /// For several files the checksum of their list, as `sha256sum` prints it.
    std::string sha256;
    /// Times of the newest file, ns since 1970.
    std::int64_t modifiedNs = 0, changedNs = 0;
    std::string option{};  ///< that names an output: "--output", "--report"
    /// Path from the record's folder, for an input in the batch's folder. Other paths may hold a
    /// patient's name, so they are not recorded.
    std::string place{};
};

/// Reads the file. \throws FileError
RecordedFile describeFile(const std::string& name, const std::filesystem::path& path);

/// The files that an input consists of, by name; the given one first unless it is a folder. For a
/// folder all regular files in and under it, for a header its data files, for a DICOMDIR all files
/// beside it; without hidden files (except Zarr's metadata), and without `output`, the folder that
/// the batch writes to.
std::vector<std::filesystem::path> filesOfInput(const std::filesystem::path& input,
                                                const std::filesystem::path& output);

/// Reads all of filesOfInput(). \throws FileError
RecordedFile describeInput(const std::filesystem::path& input, const std::filesystem::path& output);

/// True if an input has the recorded size and times. Does not read it.
bool hasTimes(const RecordedFile& recorded, const std::filesystem::path& input,
              const std::filesystem::path& output);

/// Whether two descriptions are of the same content.
bool isSameContent(const RecordedFile& a, const RecordedFile& b);

enum class FileChange { None, Gone, Changed };

/// Compares the file at `path` with its record. Does not read a file of the recorded size and times
/// (of content and of inode, which no program can put back).
FileChange changeOf(const RecordedFile& recorded, const std::filesystem::path& path);

/// "is gone", "has changed".
std::string changeText(FileChange change);

/// An option that shapes the result, with a checksum of its value, which may be a path.
struct RecordedOption {
    std::string name, sha256;
    friend bool operator==(const RecordedOption&, const RecordedOption&) = default;
};

/// How one run of a batch ended: a line of --json and, with what the result depends on, a file
/// beside the result.
struct RunRecord {
    std::string program, version;  ///< version: of the program and its libraries
    std::string name{};
    std::vector<std::string> files{};  ///< inputs, without folders
    bool hasEnded = false;
    int exitCode = 0;
    int signal = 0;                      ///< that ended the run; 0 for none
    std::string error{};                 ///< one line; may be empty
    std::vector<std::string> outputs{};  ///< written under --output, relative to the item's folder
    double seconds = 0;
    bool isOfEarlierRun = false;
    std::string madeAgain{};  ///< why an earlier result was replaced; empty: there was none
    Json report{};            ///< the run's own; may be null
    std::vector<Warning> warnings{};
    bool wasShort = false;  ///< of memory, disk or processes: it may pass elsewhere
    std::string says{};     ///< the result, in words
    std::string date{};     ///< of its end or, while it runs, its start: UTC, ISO 8601
    Json request{};         ///< adaptiso-bids's request; may be null
    std::vector<RecordedOption> options{};
    std::vector<RecordedFile> inputs{}, recordedOutputs{};

    bool hasPassed() const { return exitCode == 0 && signal == 0; }
    /// It reached a result, good or bad, that another try would not change.
    bool isFinished() const { return signal == 0 && (exitCode == 0 || exitCode == 1); }
};

/// A line of --json.
Json lineJson(const RunRecord& record);

/// Fills in how the child ended. \param inputs  paths that its error line may hold
void addResult(const ChildResult& result, const std::vector<std::filesystem::path>& inputs,
               RunRecord& record);

/// "<file>.<program>.json" in `folder`; if `file` lies in another folder or its name is too long,
/// with a checksum of its path.
std::filesystem::path recordFile(const std::filesystem::path& folder,
                                 const std::filesystem::path& file, const std::string& program);

/// All records in a folder and, of BIDS derivatives, below its sub-* folders, by path.
std::vector<std::filesystem::path> recordFiles(const std::filesystem::path& folder,
                                               bool hasSubjects);

enum class RecordFault { None, Missing, Damaged, OfAnotherVersion };

/// Reads a record or returns why it can't be read. Throws nothing, whatever the file holds. A
/// record that names a file outside its folder is damaged.
RecordFault readRecord(const std::filesystem::path& path, RunRecord& record);

/// \throws FileError  also where a link lies in its place
void writeRecord(const std::filesystem::path& file, const RunRecord& record);

/// The present time for RunRecord::date.
std::string recordDate();

/// Writes a text as a whole file. \param ownFolder  as AtomicOutput takes it \throws FileError
void writeWhole(const std::filesystem::path& file, const std::string& text,
                const std::filesystem::path& ownFolder = {});

}  // namespace adaptiso
