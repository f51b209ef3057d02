#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

/// What the small files of a BIDS dataset say.
namespace adaptiso::bids {

/// "sub-01" of "01" and of "sub-01".
std::string withPrefix(const std::string& label, const std::string& prefix);

/// Parts between separators; one where there is none.
std::vector<std::string> splitAt(const std::string& text, char separator);

/// The paths that .bidsignore of a dataset excludes, by the rules of .gitignore.
class BidsIgnore {
public:
    /// \throws FileError  it is no text
    explicit BidsIgnore(std::string_view text);
    /// \param path  relative to the dataset's root
    bool contains(const std::filesystem::path& path) const;

private:
    struct Rule {
        std::vector<std::vector<std::string>> pattern;  ///< by folders, as elementsOf() gives them
        bool isException = false;                       ///< "!"
    };
    std::vector<Rule> rules_;
};

/// participant_id in the text of participants.tsv, each with "sub-".
/// \throws FileError  it is no text, or has no such column
std::set<std::string> participantsIn(std::string_view text);

/// The column "age" of participants.tsv in years, by participant_id with "sub-"; those without a
/// number are left out. \param description  the text of participants.json, which may name another
/// unit; may be empty. \throws FileError  as participantsIn(), and where the unit is not known
std::map<std::string, double> agesIn(std::string_view text, std::string_view description);

/// "Name" or "BIDSVersion" where the text of dataset_description.json lacks it; empty if it has
/// both. \throws FileError  it is no text
std::string missingKeyOf(std::string_view description);

}  // namespace adaptiso::bids
