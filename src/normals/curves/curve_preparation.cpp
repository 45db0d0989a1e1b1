// Passes the calls of a preparation on to CurveSlices (curve_builder.h).
#include "chronormal/normals/curve_preparation.h"

#include "normals/curves/curve_builder.h"

namespace chronormal {

CurvePreparation::CurvePreparation(const Segment& segment, const CurveOptions& options, NormalCurves* reuse)
    : slices_(std::make_unique<CurveSlices>(segment, nullptr, options, NormalCurves::data_of(reuse))) {}
CurvePreparation::CurvePreparation(const Segment& segment, const NormalGroups& groups, const CurveOptions& options,
                                   NormalCurves* reuse)
    : slices_(std::make_unique<CurveSlices>(segment, &groups, options, NormalCurves::data_of(reuse))) {}

CurvePreparation::CurvePreparation(CurvePreparation&&) noexcept = default;
CurvePreparation& CurvePreparation::operator=(CurvePreparation&&) noexcept = default;
CurvePreparation::~CurvePreparation() = default;

bool CurvePreparation::prepare(double share) { return slices_->advance(share); }

NormalCurves CurvePreparation::take() { return NormalCurves(std::make_unique<CurveData>(slices_->finish())); }

}  // namespace chronormal
