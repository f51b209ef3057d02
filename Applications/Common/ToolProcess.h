#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace adaptiso {

/// Whether a program of this name is in PATH.
bool isInstalled(const std::string& program);

/// How a program of others ended.
struct ToolResult {
    int exitCode = 0;
    int signal = 0;      ///< that ended it; 0: none
    std::string output;  ///< its stdout and stderr

    bool isGood() const { return exitCode == 0 && signal == 0; }
    /// The last line of what it said, or how it ended.
    std::string reason() const;
};

namespace detail {
struct Registration;
}

/// Where temporary files go: TMPDIR, or what stands for it. \throws FileError  no folder that can
/// be written to
std::filesystem::path temporaryFolder();

/// A folder of its own for temporary files (in TMPDIR), gone with the object, also when a signal
/// ends this program; what a killed run has left goes with the next one.
class ScratchFolder {
public:
    /// \throws FileError
    ScratchFolder();
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }

    /// Where to put a file, by this program or another. Others stay when a signal comes.
    std::filesystem::path place(const std::string& name);

private:
    std::filesystem::path path_;
    std::vector<std::unique_ptr<detail::Registration>> registrations_;
};

/// Runs a program that is in PATH, in a folder, with nothing on its stdin, and waits for it. It
/// ends when this process does, before its files are removed.
/// \throws FileError  it can't be started
ToolResult runTool(const std::string& program, const std::vector<std::string>& arguments,
                   const ScratchFolder& folder);

}  // namespace adaptiso
