#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "Common/Batch.h"
#include "Common/Json.h"
#include "Pipeline.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso::bids {

/// Images of one suffix in a BIDS dataset.
struct BidsImages {
    std::string suffix;  ///< "T1w"
    std::string what;    ///< for messages
};
extern const BidsImages kBidsScans;          ///< *_T1w.nii[.gz]
extern const BidsImages kBidsSegmentations;  ///< *_dseg.nii[.gz]

/// The images of one participant, sub-*/[ses-*/]anat/, by session and name. Not an error: none.
/// \param subject   the participant's folder
/// \param sessions  labels, with or without "ses-"; empty: all, and what is in no session
/// \param target    the participant's folder of derivatives
std::vector<BatchItem> bidsImagesOf(const std::filesystem::path& subject,
                                    const std::vector<std::string>& sessions,
                                    const std::filesystem::path& target, const BidsImages& images);

/// The participants asked for, by name, without those that .bidsignore excludes.
struct ChosenSubjects {
    std::vector<std::filesystem::path> folders;
    /// "sub-02" and why its name, or one of its sessions or images, is not valid in BIDS.
    std::vector<std::pair<std::string, std::string>> faulty;
    std::vector<Warning> warnings;  ///< where participants.tsv differs
};

/// \throws InvalidInput  no BIDS dataset, no such participant, no participant; or an invalid
///                       description, unless validation is skipped
ChosenSubjects chooseSubjects(const BidsOptions& options);

/// Compares what exists of `chosen` with the request (the participant level's if none is given),
/// and writes the files of the whole dataset: quality.tsv and quality.json, summary.html,
/// dataset_description.json, README and .bidsignore.
/// \return kExitOk, or kExitCheckFailed: something is missing, failed or unsound; stderr names it
/// \throws InvalidInput  no participant has been run
int runGroup(BidsOptions options, const ChosenSubjects& chosen);

/// "01" for the entity "sub" of "sub-01_ses-2_acq-hi"; may be empty.
std::string entityOf(const std::string& name, const std::string& key);

}  // namespace adaptiso::bids
