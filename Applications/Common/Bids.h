#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "Common/Batch.h"
#include "Common/Json.h"

namespace adaptiso {

/// The placeholder for bidsLabel() of an isovalue in a file's name.
inline constexpr std::string_view kIsoLabel = "{isolabel}";

/// Images of one suffix in a BIDS dataset.
struct BidsImages {
    std::string suffix;  ///< "T1w"
    std::string what;    ///< for messages
};
extern const BidsImages kBidsScans;          ///< *_T1w.nii[.gz]
extern const BidsImages kBidsSegmentations;  ///< *_dseg.nii[.gz]

/// participant_id in participants.tsv ("sub-01"); empty if there is no such table.
std::optional<std::set<std::string>> listedParticipants(const std::filesystem::path& root);

/// The T1w images of a BIDS dataset, sub-*/[ses-*/]anat/*_T1w.nii[.gz], by name; each goes into the
/// same subfolders of `derivatives`, named by its entities ("sub-01_ses-2_acq-hi").
/// Skips files that .bidsignore lists. Two files of one name (.nii and .nii.gz) are an item with a
/// fault.
/// \param participants  labels, with or without "sub-"; empty: all
/// \throws InvalidInput  no BIDS dataset, no such participant, or one asked for has no such image
std::vector<BatchItem> findBidsScans(const std::filesystem::path& root,
                                     const std::vector<std::string>& participants,
                                     const std::filesystem::path& derivatives);

/// The same of label maps, *_dseg.nii[.gz]: in a dataset of derivatives, where they are.
std::vector<BatchItem> findBidsSegmentations(const std::filesystem::path& root,
                                             const std::vector<std::string>& participants,
                                             const std::filesystem::path& derivatives);

/// The surfaces, in formats that MeshIO reads, anywhere under sub-* of `derivatives`, by path;
/// their records go beside them. \throws InvalidInput  as findBidsScans()
std::vector<BatchItem> findBidsSurfaces(const std::filesystem::path& root,
                                        const std::vector<std::string>& participants,
                                        const std::filesystem::path& derivatives);

/// The images of one participant, sub-*/[ses-*/]anat/, by session and name. Not an error: none.
/// \param subject   the participant's folder
/// \param sessions  labels, with or without "ses-"; empty: all, and what is in no session
/// \param target    the participant's folder of derivatives
std::vector<BatchItem> bidsImagesOf(const std::filesystem::path& subject,
                                    const std::vector<std::string>& sessions,
                                    const std::filesystem::path& target, const BidsImages& images);

/// The folders sub-* in `within`, which is `root` or its derivatives: those of `participants`,
/// labels with or without "sub-"; empty: all.
/// \param option  that names them, for messages: "--participant"
/// \throws InvalidInput  `root` is no BIDS dataset, or there is no such participant
std::vector<std::filesystem::path> bidsSubjects(const std::filesystem::path& root,
                                                const std::filesystem::path& within,
                                                const std::vector<std::string>& participants,
                                                const std::string& option);

/// A number's text in letters and digits, as a BIDS label must be: "411p5" for "411.5", "m300" for
/// "-300", "1em07" for "1e-07". Two numbers never share a label.
std::string bidsLabel(std::string_view number);

/// dataset_description.json for derivatives that `program` makes of the dataset in `root`.
Json bidsDescription(const std::filesystem::path& root, const std::filesystem::path& derivatives,
                     const std::string& program);

/// Makes the folder, and its dataset_description.json, which BIDS asks for, unless it is there.
/// \throws FileError
void makeDerivatives(const std::filesystem::path& root, const std::filesystem::path& derivatives,
                     const std::string& program);

}  // namespace adaptiso
