#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace adaptiso {

/// A doubt about an input or a result that ends no run:
/// `warnings.push_back({"trailing-bytes", "3 bytes follow the image"})`.
struct Warning {
    std::string code{};  ///< of warningCodes(); scripts decide by it, so it never changes
    std::string text{};  ///< one line, without the file's name
    std::string file{};  ///< without folders; empty: of several files, or not known yet

    /// "ball.nii: 3 bytes follow the image ..."
    std::string line() const { return file.empty() ? text : file + ": " + text; }
    bool operator==(const Warning&) const = default;
};

struct WarningCode {
    std::string_view code, meaning;
    bool isNote = false;  ///< a fact worth knowing, no doubt: --strict passes it
};

/// Every code in use, by name. Documentation/Warnings.md holds the same table.
std::span<const WarningCode> warningCodes();

/// WarningCode::isNote of its code.
bool isNote(const Warning& warning);

/// Appends `more` to `warnings`; those without a file become `file`'s.
void addWarnings(std::vector<Warning>& warnings, std::span<const Warning> more,
                 const std::string& file = {});

/// "bound-over-size": a length in mm is more than a tenth of a surface's diagonal, as of a surface
/// in metres. \param name  of the length: "--max-error"
std::optional<Warning> boundOverSize(const std::string& name, double mm, double diagonalMm,
                                     const std::string& file);

/// line() of each warning.
std::vector<std::string> linesOf(std::span<const Warning> warnings);

}  // namespace adaptiso
