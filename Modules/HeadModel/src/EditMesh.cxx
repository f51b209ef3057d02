#include "EditMesh.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace adaptiso {

EditMesh::EditMesh(const TriangleMesh& mesh)
    : from_(3 * mesh.triangles.size()),
      twin_(3 * mesh.triangles.size()),
      out_(mesh.points.size(), -1),
      points_(mesh.points) {
    // Half-edges by smaller end: the two of an edge meet in a short list.
    std::vector<HalfEdge> begin(mesh.points.size() + 1);
    for (const Triangle& t : mesh.triangles) {
        for (int side = 0; side < 3; ++side) ++begin[std::min(t[side], t[(side + 1) % 3]) + 1];
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<HalfEdge> end(begin.begin(), begin.end() - 1);
    std::vector<HalfEdge> waiting(from_.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (int side = 0; side < 3; ++side) {
            const auto h = static_cast<HalfEdge>(3 * t + side);
            from_[h] = static_cast<Number>(mesh.triangles[t][side]);
            out_[from_[h]] = static_cast<Number>(h);
        }
    }
    for (HalfEdge h = 0; h < halfEdgeSlots(); ++h) {
        const VertexId low = std::min(from(h), to(h));
        const auto first = waiting.begin() + begin[low], last = waiting.begin() + end[low];
        const auto match = std::find_if(first, last, [&](HalfEdge other) {
            return from(other) == to(h) && to(other) == from(h);
        });
        if (match == last) {
            waiting[end[low]++] = h;
        } else {
            join(h, *match);
        }
    }
    for (VertexId v = 0; v < vertexSlots(); ++v) {
        if (isVertexAlive(v)) {
            ++vertexCount_;
        } else {
            freeVertices_.push_back(v);
        }
    }
}

TriangleMesh EditMesh::toMesh() const {
    TriangleMesh mesh;
    std::vector<VertexId> number(out_.size(), -1);
    for (VertexId v = 0; v < vertexSlots(); ++v) {
        if (!isVertexAlive(v)) continue;
        number[v] = std::ssize(mesh.points);
        mesh.points.push_back(points_[v]);
    }
    for (HalfEdge h = 0; h < halfEdgeSlots(); h += 3) {
        if (!isAlive(h)) continue;
        mesh.triangles.push_back({number[from_[h]], number[from_[h + 1]], number[from_[h + 2]]});
    }
    return mesh;
}

std::vector<VertexId> EditMesh::compact() {
    // the last of the free ones are used first; a split takes two triangles
    const auto keepLast = [](auto& free, std::int64_t most) {
        free.erase(free.begin(), free.end() - std::min<std::int64_t>(most, std::ssize(free)));
    };
    keepLast(freeVertices_, vertexCount_);
    keepLast(freeTriangles_, 2 * vertexCount_);
    std::vector<VertexId> newVertex(out_.size(), -1), former;
    for (const VertexId v : freeVertices_) newVertex[v] = 0;
    for (VertexId v = 0; v < vertexSlots(); ++v) {
        if (!isVertexAlive(v) && newVertex[v] < 0) continue;
        newVertex[v] = std::ssize(former);
        former.push_back(v);
    }
    std::vector<HalfEdge> newFirst(from_.size() / 3, -1), formerFirst;
    for (const HalfEdge first : freeTriangles_) newFirst[first / 3] = 0;
    for (HalfEdge first = 0; first < halfEdgeSlots(); first += 3) {
        if (!isAlive(first) && newFirst[first / 3] < 0) continue;
        newFirst[first / 3] = 3 * std::ssize(formerFirst);
        formerFirst.push_back(first);
    }
    const auto newHalfEdge = [&](HalfEdge h) { return newFirst[h / 3] + h % 3; };

    EditMesh result;
    result.vertexCount_ = vertexCount_;
    for (const VertexId v : former) {
        result.out_.push_back(static_cast<Number>(isVertexAlive(v) ? newHalfEdge(out_[v]) : -1));
        result.points_.push_back(points_[v]);
    }
    for (const HalfEdge first : formerFirst) {
        for (HalfEdge h = first; h < first + 3; ++h) {
            result.from_.push_back(static_cast<Number>(isAlive(h) ? newVertex[from_[h]] : -1));
            result.twin_.push_back(static_cast<Number>(isAlive(h) ? newHalfEdge(twin_[h]) : -1));
        }
    }
    for (const VertexId v : freeVertices_) result.freeVertices_.push_back(newVertex[v]);
    for (const HalfEdge first : freeTriangles_) {
        result.freeTriangles_.push_back(newFirst[first / 3]);
    }
    *this = std::move(result);
    return former;
}

std::int64_t EditMesh::valence(VertexId v) const {
    std::int64_t count = 0;
    forEachOut(v, [&](HalfEdge) { ++count; });
    return count;
}

void EditMesh::setTriangle(HalfEdge first, VertexId a, VertexId b, VertexId c) {
    const std::array corners{a, b, c};
    for (HalfEdge h = first; h < first + 3; ++h) {
        from_[h] = static_cast<Number>(corners[h - first]);
        out_[corners[h - first]] = static_cast<Number>(h);
    }
}

EditMesh::HalfEdge EditMesh::newTriangle() {
    if (!freeTriangles_.empty()) {
        const HalfEdge first = freeTriangles_.back();
        freeTriangles_.pop_back();
        return first;
    }
    const HalfEdge first = halfEdgeSlots();
    from_.resize(from_.size() + 3, -1);
    twin_.resize(twin_.size() + 3, -1);
    return first;
}

bool EditMesh::canFlip(HalfEdge h) const {
    const VertexId c = opposite(h), d = opposite(twin(h));
    bool isFree = c != d;
    forEachOut(c, [&](HalfEdge out) { isFree = isFree && to(out) != d; });
    return isFree && valence(from(h)) > 3 && valence(to(h)) > 3;
}

void EditMesh::flip(HalfEdge h) {
    // a -> b with c on the left and d on the right becomes d -> c
    const HalfEdge g = twin(h);
    const VertexId a = from(h), b = to(h), c = opposite(h), d = opposite(g);
    const HalfEdge bc = twin(next(h)), ca = twin(prev(h)), ad = twin(next(g)), db = twin(prev(g));
    const HalfEdge left = h - h % 3, right = g - g % 3;
    setTriangle(left, d, c, a);
    setTriangle(right, c, d, b);
    join(left, right);
    join(left + 1, ca);
    join(left + 2, ad);
    join(right + 1, db);
    join(right + 2, bc);
}

VertexId EditMesh::split(HalfEdge h, const Vec3& p) {
    const HalfEdge g = twin(h);
    const VertexId a = from(h), b = to(h), c = opposite(h), d = opposite(g);
    const HalfEdge bc = twin(next(h)), db = twin(prev(g)), ca = twin(prev(h)), ad = twin(next(g));
    VertexId m = vertexSlots();
    if (freeVertices_.empty()) {
        out_.push_back(-1);
        points_.push_back(p);
    } else {
        m = freeVertices_.back();
        freeVertices_.pop_back();
        points_[m] = p;
    }
    ++vertexCount_;
    const HalfEdge left = h - h % 3, right = g - g % 3;
    const HalfEdge newLeft = newTriangle(), newRight = newTriangle();
    setTriangle(left, a, m, c);
    setTriangle(newLeft, m, b, c);
    setTriangle(right, m, a, d);
    setTriangle(newRight, b, m, d);
    join(left, right);
    join(left + 1, newLeft + 2);
    join(left + 2, ca);
    join(newLeft, newRight);
    join(newLeft + 1, bc);
    join(right + 1, ad);
    join(right + 2, newRight + 1);
    join(newRight + 2, db);
    return m;
}

bool EditMesh::canCollapse(HalfEdge h) const {
    const VertexId a = from(h), b = to(h);
    if (vertexCount_ <= 4) return false;
    if (valence(opposite(h)) <= 3 || valence(opposite(twin(h))) <= 3) return false;
    std::int64_t common = 0;
    forEachOut(a, [&](HalfEdge ofA) {
        forEachOut(b, [&](HalfEdge ofB) { common += to(ofA) == to(ofB); });
    });
    return common == 2;
}

void EditMesh::collapse(HalfEdge h) {
    const HalfEdge g = twin(h);
    const VertexId a = from(h), b = to(h);
    const HalfEdge left = h - h % 3, right = g - g % 3;
    const HalfEdge bc = twin(next(h)), ca = twin(prev(h)), ad = twin(next(g)), db = twin(prev(g));
    forEachOut(a, [&](HalfEdge out) { from_[out] = static_cast<Number>(b); });
    join(bc, ca);
    join(ad, db);
    // The twins outside the two triangles live on and leave b, c, d.
    for (const HalfEdge e : {bc, ca, ad, db}) out_[from_[e]] = static_cast<Number>(e);
    out_[a] = -1;
    freeVertices_.push_back(a);
    for (const HalfEdge first : {left, right}) {
        for (HalfEdge e = first; e < first + 3; ++e) from_[e] = twin_[e] = -1;
        freeTriangles_.push_back(first);
    }
    --vertexCount_;
}

}  // namespace adaptiso
