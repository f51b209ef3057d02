#include "Words.h"

namespace adaptiso::python {

Method methodOf(const std::string& word) {
    return choose<Method>("method", word,
                          {{"adaptive", Method::Adaptive},
                           {"boxes", Method::Boxes},
                           {"dmc", Method::DiscretizedMarchingCubes},
                           {"asc", Method::SkeletonClimbing},
                           {"mc", Method::MarchingCubes}});
}

Border borderOf(const std::string& word) {
    return choose<Border>("border", word, {{"closed", Border::Closed}, {"open", Border::Open}});
}

CoordinateFrame frameOf(const std::string& word) {
    return choose<CoordinateFrame>("frame", word,
                                   {{"ras", CoordinateFrame::Ras},
                                    {"lps", CoordinateFrame::Lps},
                                    {"tkras", CoordinateFrame::TkRas},
                                    {"voxel", CoordinateFrame::Voxel}});
}

Profile profileOf(const std::string& word) {
    return choose<Profile>(
        "profile", word,
        {{"bem", Profile::Bem}, {"print", Profile::Print}, {"view", Profile::View}});
}

std::optional<CoordinateFrame> frameOf(const std::optional<std::string>& word) {
    if (!word) return std::nullopt;
    return frameOf(*word);
}

}  // namespace adaptiso::python
