#include "adaptiso/HeadPipeline/TetrahedraJson.h"

namespace adaptiso {

Json elementShapesJson(const TetrahedraReport& report) {
    return {{"dihedralDeg",
             {{"minimum", number(report.leastDihedralDeg)}, {"p5", number(report.p5DihedralDeg)}}},
            {"radiusEdge",
             {{"maximum", number(report.mostRadiusEdge)}, {"p95", number(report.p95RadiusEdge)}}}};
}

}  // namespace adaptiso
