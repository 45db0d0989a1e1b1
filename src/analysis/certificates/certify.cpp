#include "chronormal/analysis/certify.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "analysis/certificates/angle_bound.h"
#include "analysis/certificates/line_bound.h"
#include "analysis/certificates/scheme_curves.h"
#include "chronormal/core/parallel.h"
#include "chronormal/normals/normal_curves.h"
#include "core/blocks.h"
#include "schemes/fitted_curves.h"

namespace chronormal {
namespace {

constexpr std::size_t kMostPieces = 256;
// The smallest width of a piece in t. A piece of this width is not cut further, since such a piece is practically a
// single instant.
constexpr double kNarrowest = 0x1p-40;
constexpr double kPromisedShare = 0x1p-26;  // relative error of a control normal that face_control_normals() guarantees
constexpr std::size_t kBlockSize = 1024;

// The normal n(t) over [0, 1], scaled to a size of about 1, and a bound of its error.
struct Normal {
  Bernstein<Vec3d, 2> n;
  Bernstein<double, 2> error;

  [[nodiscard]] NormalPiece over(double a, double b) const { return {restrict_to(n, a, b), restrict_to(error, a, b)}; }
};

constexpr double kLongestOfThree = 1.7320509;  // the largest length of a vector whose components are at most 1
// The rounding error of splitting a polynomial, relative to its largest coefficient.
constexpr double kCutting = 0x1p-46;

// Returns the factor that scales a vector with the largest component `largest` to a largest component of 1. Returns 1
// for the zero vector, whose error is then not scaled.
double scale_of(double largest) { return largest == 0 ? 1 : 1 / largest; }

// Divides a quadratic that is certainly zero at an end of [0, 1] by t or by 1 - t. The quotient has the same direction
// as the quadratic, and is not zero at that end. Returns no value if the quadratic is certainly zero throughout.
std::optional<Normal> without_zero_ends(const ControlNormals& c, const ControlErrors& errors) {
  const double largest = std::max({max_abs(c.n0), max_abs(c.m), max_abs(c.n1)});
  if (largest == 0 && errors == ControlErrors{}) return std::nullopt;
  const double scale = scale_of(largest);
  const Vec3d n0 = scale * c.n0, m = scale * c.m, n1 = scale * c.n1;
  const auto error_of = [&](std::size_t k, const Vec3d& v) {
    return kLongestOfThree * scale * errors[k] + kCutting * max_abs(v);
  };
  const Bernstein<double, 2> error = {error_of(0, n0), error_of(1, m), error_of(2, n1)};
  const auto is_zero = [&](std::size_t k, const Vec3d& v) { return v == Vec3d{} && errors[k] == 0; };
  const bool no_start = is_zero(0, n0), no_middle = is_zero(1, m), no_end = is_zero(2, n1);
  const auto constant = [&](const Vec3d& v, double e) { return Normal{{v, v, v}, {e, e, e}}; };
  const auto line = [&](const Vec3d& a, double ea, const Vec3d& b, double eb) {
    return Normal{{a, 0.5 * (a + b), b}, {ea, 0.5 * (ea + eb), eb}};
  };
  if (no_start && no_end) return constant(m, error[1]);
  if (no_start && no_middle) return constant(n1, error[2]);
  if (no_end && no_middle) return constant(n0, error[0]);
  if (no_start) return line(2.0 * m, 2 * error[1], n1, error[2]);
  if (no_end) return line(n0, error[0], 2.0 * m, 2 * error[1]);
  return Normal{{n0, m, n1}, error};
}

// A piece of the segment, from t = a to t = b. Pieces are ordered by their bounds `upper`, so that the largest bound
// comes first.
struct Piece {
  double a, b;
  double upper;
  double uncertainty;  // uncertainty of the angle in the middle of the piece, in radians

  friend bool operator<(const Piece& x, const Piece& y) { return x.upper < y.upper; }
};

template <class Curve>
ErrorBounds bounds_of(const Curve& curve, const Normal& normal, const CertifyOptions& options, double enough,
                      bool only_whether = false) {
  std::array<Piece, kMostPieces> pieces;
  std::size_t count = 0;
  ErrorBounds result;
  const auto add = [&](double a, double b) {
    const CurvePiece shown = curve.over(a, b);
    const NormalPiece exact = normal.over(a, b);
    const MiddleAngle middle = middle_angle(shown, exact);
    if (const double lower = middle.angle - middle.uncertainty; lower > result.lower) {
      result.lower = lower;
      result.at = a + (b - a) / 2;
    }
    pieces[count++] = {a, b, largest_angle(shown, exact), middle.uncertainty};
    std::push_heap(pieces.begin(), pieces.begin() + static_cast<std::ptrdiff_t>(count));
  };
  add(0, 1);
  const std::size_t most = std::min(options.most_pieces, kMostPieces);
  for (;;) {
    const Piece worst = pieces[0];
    result.upper = worst.upper;
    result.from = worst.a;
    result.to = worst.b;
    const double allowed = options.relative_gap * worst.upper + options.gap + 2 * worst.uncertainty;
    const bool is_close = worst.upper < std::numbers::pi && worst.upper - result.lower <= allowed;
    if (only_whether && result.lower > enough) return result;
    if (is_close || worst.upper <= enough || count >= most || worst.b - worst.a <= kNarrowest) return result;
    std::pop_heap(pieces.begin(), pieces.begin() + static_cast<std::ptrdiff_t>(count--));
    const double middle = worst.a + (worst.b - worst.a) / 2;
    add(worst.a, middle);
    add(middle, worst.b);
  }
}

// The warped time x = r t / ((1-r)(1-t) + r t) in which an arc runs, where r is `share`. At x, the arc has to be
// compared with the normal at the t that belongs to x. As a function of x, this normal is again a quadratic up to a
// factor: control normal k is multiplied by r^(2-k) (1-r)^k.
struct Warp {
  double share;

  [[nodiscard]] Normal normal(Normal in_time) const {
    for (std::size_t k = 0; k <= 2; ++k) {
      double weight = 1;
      for (std::size_t i = 0; i < 2; ++i) weight *= i < 2 - k ? share : 1 - share;
      in_time.n[k] = weight * in_time.n[k];
      in_time.error[k] *= weight;
    }
    return in_time;
  }
  [[nodiscard]] double time(double x) const { return (1 - share) * x / (share * (1 - x) + (1 - share) * x); }
};

constexpr ErrorBounds kUnknown{0, std::numbers::pi, 0, 0, 1};

// Finds the certificates of the elements of a block, and has the data that all these elements share.
class Certifier {
 public:
  explicit Certifier(const Scheme& scheme)
      : fitted_(scheme.fitted_curves()),
        is_exact_(scheme.is_exact()),
        reads_positions_(is_exact_ && !scheme.uses_control_normals()) {}

  [[nodiscard]] ErrorBounds bounds(std::size_t i, const ControlNormals& normals, const ControlErrors& errors,
                                   const CertifyOptions& options, double enough) const {
    if (reads_positions_) return {0, kExactTolerance, 0, 0, 1};
    const std::optional<Normal> normal = without_zero_ends(normals, errors);
    if (!normal) return {0, 0, 0, 0, 1};
    if (is_exact_) return bounds_of(CubicCurve(normal->n, kExactTolerance), *normal, options, enough);
    return of_fitted(i, *normal, options, enough);
  }

 private:
  [[nodiscard]] ErrorBounds of_fitted(std::size_t i, const Normal& normal, const CertifyOptions& options,
                                      double enough) const {
    if (fitted_ == nullptr) return kUnknown;
    const ElementCoefficients c = coefficients_of(fitted_->coefficients, i);
    switch (fitted_->formula) {
      case Formula::kRational:
        return bounds_of(CubicCurve(c), normal, options, enough);
      case Formula::kGreatArc:
      case Formula::kCircleArc:
        return bounds_of(ArcCurve(fitted_->formula, c), normal, options, enough);
      case Formula::kTimedCircleArc:
        return of_warped_arc(c, normal, options, enough);
      case Formula::kDeCasteljau:
        return bounds_of(SphericalCurve(fitted_->coefficients.plane_count / 3, c), normal, options, enough);
      default:
        if (!fitted_->basis) return kUnknown;
        if (fitted_->basis->degree() <= 3) return bounds_of(CubicCurve(*fitted_->basis, c), normal, options, enough);
        return bounds_of(SumCurve(*fitted_->basis, c), normal, options, enough);
    }
  }

  static ErrorBounds of_warped_arc(ElementCoefficients c, const Normal& normal, const CertifyOptions& options,
                                   double enough) {
    const Warp warp{static_cast<double>(c[10])};
    if (!(warp.share > 0 && warp.share < 1)) return kUnknown;
    ErrorBounds bounds = bounds_of(ArcCurve(Formula::kTimedCircleArc, c), warp.normal(normal), options, enough);
    for (double* t : {&bounds.at, &bounds.from, &bounds.to}) *t = warp.time(*t);
    return bounds;
  }

  std::shared_ptr<const FittedCurves> fitted_;
  bool is_exact_, reads_positions_;
};

ControlErrors promised_errors(const ControlNormals& c) {
  return {kPromisedShare * max_abs(c.n0), kPromisedShare * max_abs(c.m), kPromisedShare * max_abs(c.n1)};
}

}  // namespace

void certify(const Scheme& scheme, const ElementBlock& block, std::span<ErrorBounds> result,
             const CertifyOptions& options, std::span<const ControlErrors> errors) {
  assert(result.size() == block.elements.count && block.normals.size() == block.elements.count);
  assert(errors.empty() || errors.size() == result.size());
  const Certifier certifier(scheme);
  double enough = options.enough;
  for (std::size_t i = 0; i < result.size(); ++i) {
    check_interruption();
    const ControlErrors of_normals = errors.empty() ? promised_errors(block.normals[i]) : errors[i];
    result[i] = certifier.bounds(i, block.normals[i], of_normals, options, enough);
    if (options.only_worst) enough = std::max(enough, result[i].lower);
  }
}

inline namespace internal {

double line_error(const ControlNormals& normals, double a, double b, const Vec3d& from, const Vec3d& to,
                  double enough) noexcept {
  const std::optional<Normal> normal = without_zero_ends(normals, promised_errors(normals));
  if (!normal) return 0;
  const NormalPiece piece = normal->over(a, b);
  return bounds_of(CubicCurve(from, kViewerRounding, to, kViewerRounding), Normal{piece.n, piece.error}, {}, enough,
                   true)
      .upper;
}

}  // namespace internal

Result<std::vector<ErrorBounds>> certify(std::string_view name, const Segment& segment, const CertifyOptions& options,
                                         Threads threads) {
  if (const auto scheme = make_scheme(name); !scheme) return scheme.error();
  std::vector<ErrorBounds> result(segment.topology->face_count());
  blocks_on(threads, result.size(), kBlockSize, [&](IndexRange faces) {
    std::vector<ControlNormals> normals(faces.count);
    face_control_normals(segment, faces, normals);
    const std::unique_ptr<Scheme> scheme = make_scheme(name).value();
    const ElementBlock block{&segment, faces, normals};
    scheme->prepare(block);
    certify(*scheme, block, std::span(result).subspan(faces.first, faces.count), options);
  });
  return result;
}

}  // namespace chronormal
