#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "Common/Batch.h"
#include "Common/BatchRecord.h"

namespace adaptiso {

/// What an item's run is to leave: a surface, or what a run finds that makes none.
struct PlannedRecord {
    std::filesystem::path file;       ///< of the record
    std::filesystem::path surface;    ///< as far as it is known before; empty: none
    std::vector<KeptOption> options;  ///< that shape it
};

/// Which runs a batch has, with which options, and where they write.
class BatchPlan {
public:
    /// Finds the inputs, checks options and outputs, and makes the batch's own folder.
    /// \throws as runBatch()
    BatchPlan(const BatchProgram& program, const BatchOptions& batch, const CommonOptions& common);

    const std::vector<BatchItem>& items() const { return items_; }
    /// A page, empty: none.
    const std::filesystem::path& summary() const { return summary_; }
    bool keepsRecords() const { return program_.keepsRecords || !base_.empty(); }

    /// The folder that all is written to; empty: nobody said.
    const std::filesystem::path& folder() const { return base_; }

    /// At least one; two items have none in common.
    std::vector<PlannedRecord> records(const BatchItem& item) const;
    /// What an item's run reads: the inputs, and what options name.
    std::vector<std::filesystem::path> inputs(const BatchItem& item) const;
    /// What an item's run is asked to write besides surfaces, as options and the paths that they
    /// name.
    std::vector<std::pair<std::string, std::filesystem::path>> extras(const BatchItem& item) const;
    /// All options of an item's run, and the inputs.
    std::vector<std::string> arguments(const BatchItem& item) const;
    /// `names`, files that the item's run has written under --output, relative to the item's
    /// folder.
    std::vector<std::string> outputs(const BatchItem& item,
                                     const std::vector<std::string>& names) const;

private:
    void checkOptions() const;
    void findItems();
    void prepareOutputs();
    void requireOwnRecords() const;
    std::vector<std::string> options(const BatchItem& item) const;
    bool isOutput(const std::string& option) const;
    bool isInput(const std::string& option) const;
    std::string outputPattern(const BatchItem& item) const;

    const BatchProgram& program_;
    const BatchOptions& batch_;
    const CommonOptions& common_;
    std::filesystem::path base_;  ///< where all goes; empty: nobody said
    std::filesystem::path summary_;
    std::vector<BatchItem> items_;
};

}  // namespace adaptiso
