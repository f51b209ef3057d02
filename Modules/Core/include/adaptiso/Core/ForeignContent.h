#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace adaptiso {

/// Content that does not belong in a data file of its name.
enum class ForeignKind {
    StandIn,  ///< the data are elsewhere: a pointer, a placeholder, an error page, zeros, nothing
    Packed,   ///< an archive or a packed file
    Other,    ///< a file of another kind: a picture, a document, another program's format
};

struct ForeignContent {
    ForeignKind kind{};
    std::string fault;   ///< "is a git-lfs pointer, its 1234 bytes of data are not here"
    std::string remedy;  ///< "fetch them: git lfs pull"
};

/// Number of first bytes that foreignContentOf() looks at.
inline constexpr std::size_t kForeignHeadBytes = 1024;

/// Recognises what no reader of this library reads, by the first bytes of a file.
///
/// Files that a reader knows go there first: some formats hold anything in their first bytes
/// (DICOM's preamble may be a TIFF header). \param head        the file's first kForeignHeadBytes
/// bytes, all of a shorter file \param file        its name, for the remedy; it is not opened
/// \param isInflated  `head` was inflated from a gzip file
/// \return            empty if nothing is known of such content
std::optional<ForeignContent> foreignContentOf(std::string_view head,
                                               const std::filesystem::path& file,
                                               bool isInflated = false);

/// The same for a file on disk; nothing is inflated. Links of git-annex to content that was not
/// fetched, placeholders of cloud folders (by name) and files of zeros alone, whatever their
/// length, are recognised too. Never opens pipes or devices. \return  empty for other missing or
/// unreadable files
std::optional<ForeignContent> findForeignContent(const std::filesystem::path& file);

}  // namespace adaptiso
