#include <algorithm>
#include <cmath>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/HeadModel/Landmarks.h"

namespace adaptiso {

std::vector<double> carriedUncertaintyMm(
    const TriangleMesh& skin, const Landmarks& landmarks,
    const std::function<std::vector<Vec3>(const Landmarks&)>& positions) {
    const std::vector<Vec3> places = positions(landmarks);
    std::vector<double> squares(places.size(), 0);
    const Vec3 ears = 0.5 * (landmarks.leftEarMm + landmarks.rightEarMm);
    const Vec3 right = normalized(landmarks.rightEarMm - landmarks.leftEarMm);
    const Vec3 up = normalized(cross(right, landmarks.nasionMm - ears));
    const Vec3 front = cross(up, right);
    /// \param moved  the landmarks with one of them moved by a vector
    const auto carry = [&](double mm, const std::vector<Vec3>& directions, const auto& moved) {
        if (mm == 0) return;
        std::vector<double> largest(places.size(), 0);
        for (const Vec3& direction : directions) {
            for (const double way : {-mm, mm}) {
                std::vector<Vec3> there;
                try {
                    there = positions(moved(way * direction));
                } catch (const InvalidInput&) {
                    continue;  // nobody's nasion and ears
                }
                for (std::size_t n = 0; n < places.size(); ++n) {
                    largest[n] = std::max(largest[n], norm(there[n] - places[n]));
                }
            }
        }
        for (std::size_t n = 0; n < places.size(); ++n) squares[n] += largest[n] * largest[n];
    };
    const auto onSkin = [&](const Vec3& p) { return projectedOntoSkin({p}, skin).pointsMm[0]; };
    const auto mover = [&](Vec3 Landmarks::*place) {
        return [&landmarks, &onSkin, place](const Vec3& by) {
            Landmarks moved = landmarks;
            moved.*place = onSkin(landmarks.*place + by);
            // a guessed inion follows nasion and ears
            if (moved.inionUncertaintyMm > 0) moved.inionMm.reset();
            return moved;
        };
    };
    carry(landmarks.nasionUncertaintyMm, {right, up}, mover(&Landmarks::nasionMm));
    carry(landmarks.earUncertaintyMm, {front, up}, mover(&Landmarks::leftEarMm));
    carry(landmarks.earUncertaintyMm, {front, up}, mover(&Landmarks::rightEarMm));
    carry(landmarks.inionUncertaintyMm, {up}, [&](const Vec3& by) {
        Landmarks moved = landmarks;
        moved.inionMm = onSkin(*landmarks.inionMm + by);
        return moved;
    });
    std::vector<double> uncertainty;
    for (const double square : squares) uncertainty.push_back(std::sqrt(square));
    return uncertainty;
}

}  // namespace adaptiso
