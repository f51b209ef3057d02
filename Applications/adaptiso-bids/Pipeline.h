#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "Common/CommonOptions.h"
#include "adaptiso/Core/Outliers.h"

namespace adaptiso::bids {

/// The two levels of a BIDS App.
enum class BidsLevel { Participant, Group };

/// Products that adaptiso-bids can make, in their order.
inline constexpr const char* kProducts[] = {"surfaces", "bem", "labels", "check"};

struct BidsOptions {
    std::filesystem::path dataset;  ///< BIDS_DIR
    std::filesystem::path output;   ///< OUT_DIR
    BidsLevel level{};
    std::vector<std::string> participants, sessions;  ///< labels; empty for all
    bool skipsValidation = false;

    /// Products to make (kProducts), each with its program's options: "iso=100,largest".
    std::map<std::string, std::string> wanted;
    std::map<std::string, std::string> lists;  ///< the same options as given; empty if not
    std::filesystem::path segmentations;       ///< a dataset; empty for `dataset`
    bool makesPictures = true;

    bool makes(const std::string& product) const { return wanted.contains(product); }
    bool namesProducts() const { return wanted.size() > (makes("check") ? 1 : 0); }

    OutlierRule outliers;
    std::optional<int> jobs;
    CommonOptions common;
};

/// Makes what is asked for of every participant, or a table and a page of what was made.
/// \return  kExitOk; kExitCheckFailed: some of it failed or is missing; kExitBadInput: a run was
///          killed or short of memory or disk, so that another try may help
/// \throws UsageError, InvalidInput, FileError
int runBids(const BidsOptions& options);

}  // namespace adaptiso::bids
