#include "workflow/json/face_figure_json.h"

#include <cmath>
#include <span>

#include "workflow/json/json.h"

namespace chronormal::inline internal {
namespace {

Json rounded(double value) {
  constexpr double kDigits = 1e7;
  if (!std::isfinite(value)) return {};
  return std::round(value * kDigits) / kDigits + 0.0;  // the sum turns -0 into 0
}

Json flat(std::span<const Vec3d> vectors) {
  Json json = Json::array();
  for (const Vec3d& v : vectors) {
    for (const double component : {v.x, v.y, v.z}) json.push_back(rounded(component));
  }
  return json;
}

template <class Values>
Json null_if_empty(const Values& values, const Json& json) {
  return values.empty() ? Json() : json;
}

Json scheme_object(const SchemeFigure& scheme) {
  Json degrees = Json::array(), lengths = Json::array();
  for (const double angle : scheme.angles) degrees.push_back(rounded(angle * kDegreesPerRadian));
  for (const double length : scheme.lengths) lengths.push_back(length);
  return {{"scheme", scheme.scheme},
          {"sum_degrees", scheme.sum * kDegreesPerRadian},
          {"degrees", std::move(degrees)},
          {"normals", flat(scheme.normals)},
          {"lengths", null_if_empty(scheme.lengths, lengths)},
          {"nodes", null_if_empty(scheme.nodes, flat(scheme.nodes))},
          {"points", null_if_empty(scheme.points, flat(scheme.points))},
          {"tangents", null_if_empty(scheme.tangents, flat(scheme.tangents))}};
}

}  // namespace

Json face_figure_object(const FaceFigure& figure) {
  Json from = Json::array(), to = Json::array();
  for (const auto& corner : figure.corners) {
    from.push_back({corner[0].x, corner[0].y, corner[0].z});
    to.push_back({corner[1].x, corner[1].y, corner[1].z});
  }
  Json json = {{"face", figure.face},       {"segment", figure.segment},
               {"from", std::move(from)},   {"to", std::move(to)},
               {"t", figure.times},         {"normals", flat(figure.normals)},
               {"lengths", figure.lengths}, {"matrix", figure.matrix ? Json(*figure.matrix) : Json()},
               {"schemes", Json::array()}};
  for (const SchemeFigure& scheme : figure.schemes) json["schemes"].push_back(scheme_object(scheme));
  return json;
}

std::string face_figure_json(const std::string& input, const FaceFigure& figure) {
  Json json = json_of_command("compare");
  json["input"] = input;
  json["figure"] = face_figure_object(figure);
  return json_text(json);
}

}  // namespace chronormal::inline internal
