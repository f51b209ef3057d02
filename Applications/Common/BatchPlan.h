#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "Common/Batch.h"

namespace adaptiso {

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

    /// The options of an item's run that say what is made.
    std::vector<std::string> options(const BatchItem& item) const;
    /// The same with those that make no difference to it, and the inputs.
    std::vector<std::string> arguments(const BatchItem& item) const;
    /// `names`, files that the item's run has written under --output, relative to the item's
    /// folder.
    std::vector<std::string> outputs(const BatchItem& item,
                                     const std::vector<std::string>& names) const;
    /// What the item's run has written for `option`; empty: not asked for, or not there.
    std::filesystem::path written(const BatchItem& item, const std::string& option) const;

private:
    void checkOptions() const;
    void findItems();
    void prepareOutputs();
    bool isOutput(const std::string& option) const;
    std::string outputPattern() const;

    const BatchProgram& program_;
    const BatchOptions& batch_;
    const CommonOptions& common_;
    std::filesystem::path base_;  ///< where all goes; empty: nobody said
    std::filesystem::path summary_;
    std::vector<BatchItem> items_;
};

}  // namespace adaptiso
