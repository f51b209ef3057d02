#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace adaptiso {

/// What one run of a batch works on.
struct BatchItem {
    std::string name;                           ///< stands for {name}, and names the record
    std::vector<std::filesystem::path> inputs;  ///< one, or the surfaces of one head
    std::filesystem::path folder;               ///< outputs and record go there
};

/// The inputs that a list names: one a line, with a name after a tab where one is given; empty
/// lines and those that begin with # are left out. Paths are relative to the current folder. \param
/// list          a file; "-": stdin \param holdsSurfaces  lines hold the surfaces of one head, with
/// tabs between, instead; the name
///                      is that of the folder of the first
/// \param nameOf        name of an input without one
/// \throws FileError    the list can't be read
/// \throws InvalidInput  it names nothing, or a line has too many parts
std::vector<BatchItem> readBatchList(
    const std::filesystem::path& list, bool holdsSurfaces,
    const std::function<std::string(const std::filesystem::path&)>& nameOf);

/// The name of the folder that holds `file`.
std::string folderName(const std::filesystem::path& file);

/// The T1w images of a BIDS dataset, sub-*/[ses-*/]anat/*_T1w.nii[.gz], by name; each goes into the
/// same subfolders of `derivatives`, named by its entities ("sub-01_ses-2_acq-hi").
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

/// Makes the folder, and its dataset_description.json, which BIDS asks for, unless it is there.
/// \throws FileError
void makeDerivatives(const std::filesystem::path& derivatives, const std::string& program);

/// \throws InvalidInput  two items would write under one name
void requireOwnNames(const std::vector<BatchItem>& items);

}  // namespace adaptiso
