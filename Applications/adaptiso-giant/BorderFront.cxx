#include "BorderFront.h"

#include <algorithm>

namespace adaptiso::giant {

std::vector<BorderFront::Vertex*> BorderFront::add(const PieceSummary& piece) {
    std::vector<Vertex*> border;
    border.reserve(piece.border.size());
    for (const BorderVertex& v : piece.border) {
        const auto [at, isNew] = vertices_.try_emplace(v.index);
        if (isNew) at->second.serial = seen_++;
        at->second.isNew = isNew;
        border.push_back(&at->second);
    }
    for (const auto& [from, to] : piece.borderEdges) {
        Vertex &a = *border[from], &b = *border[to];
        const bool isClosed = open_.erase({b.serial, a.serial}) > 0;
        if (!isClosed) open_.insert({a.serial, b.serial});
        a.openEdges += isClosed ? -1 : 1;
        b.openEdges += isClosed ? -1 : 1;
    }
    longest_ = std::max(longest_, std::ssize(vertices_));
    return border;
}

}  // namespace adaptiso::giant
