#pragma once

#include <deque>
#include <filesystem>
#include <string>
#include <vector>

#include "Common/Batch.h"
#include "Common/BatchOptions.h"
#include "Pipeline.h"

namespace adaptiso {

/// One kind of what is made, as a batch of another program.
struct Product {
    std::string name;   ///< "surfaces", "bem", "labels", "check"
    std::string needs;  ///< "T1w image"
    BatchProgram program;
    BatchOptions batch;
    std::vector<BatchItem> items;
    std::vector<std::string> without;  ///< participants that have nothing to make it of: "sub-03"
};

/// The request for a product, kept in its records for the group level.
Json askedOf(const BidsOptions& options, const std::string& product);

/// What is asked for but the check, with the images of `subjects`. Its addresses stay.
/// \throws UsageError  options that no program has  \throws InvalidInput
std::deque<Product> findProducts(const BidsOptions& options,
                                 const std::vector<std::filesystem::path>& subjects);

/// The check of the surfaces that have been made, as their records in `surfaces` tell.
Product checkOf(const BidsOptions& options, const Product& surfaces);

/// Gives `product.items` to its program. To be called when it has got its place.
void bindItems(Product& product);

}  // namespace adaptiso
