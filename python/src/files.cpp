// Reads files, and returns the results of the program's commands to Python: reports as JSON, errors and motions as
// arrays.
#include <algorithm>
#include <map>
#include <string_view>

#include "arguments.h"
#include "computation.h"
#include "io/bytes/expansion.h"
#include "workflow/json/json.h"

namespace chronormal::python {
namespace {

constexpr const char* kBytes = "<bytes>";  // the name of a file that was given as bytes

// Reads the dict that python/chronormal makes from its arguments. The keys of the dict are the names of members of
// InputOptions.
InputOptions options_of(const py::dict& source) {
  InputOptions options;
  options.files = source["files"].cast<std::vector<std::string>>();
  options.samples = source["samples"].cast<std::vector<std::string>>();
  options.base = source["base"].cast<std::string>();
  options.frames_per_second = source["fps"].cast<double>();
  options.animation = source["animation"].cast<std::string>();
  options.world = source["world"].cast<bool>();
  options.velocities = source["velocities"].cast<bool>();
  options.path = source["path"].cast<std::string>();
  options.loop = source["loop"].cast<bool>();
  options.strict = source["strict"].cast<bool>();
  if (const py::object bytes = source["bytes"]; !bytes.is_none()) {
    const std::string_view view = bytes.cast<std::string_view>();  // the bytes object outlives the input
    options.files = {kBytes};
    options.resolve = [view](const std::string& name) -> Result<std::string_view> {
      if (name == kBytes) return view;
      return Error{
          ErrorCode::kFailed, name,
          "the input refers to this file, which cannot be found because the input was given as bytes; give the name of "
          "the input file instead"};
    };
  }
  return options;
}

// Opens the files of an input. Raises an error if the chosen path of vertices is not possible for this input.
Input open_files(const py::dict& source, bool allow_mesh, KeepShading shading) {
  InputOptions options = options_of(source);
  options.allow_mesh = allow_mesh;
  options.shading = shading;
  if (const Status status = check_input(options); !status) raise(status.error());
  Input input = without_gil([&] { return open_input(options); });
  if (options.is_curved()) (void)without_gil([&] { return input.stream(); });
  return input;
}

constexpr int kStateVersion = 1;

// Returns the bytes of a text that string_of() has made.
std::string bytes_of_text(const py::handle& text) {
  PyObject* const made = PyUnicode_AsEncodedString(text.ptr(), "utf-8", "surrogateescape");
  if (made == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::bytes>(made);
}

// A motion that was read from files, or made from arrays. The object also gives the arrays of the motion, and normals
// at chosen moments, to Python.
class ReadMotion : public ZeroedObject {
 public:
  explicit ReadMotion(const py::dict& source) : bytes_(source["bytes"]) {
    input_.emplace(open_files(source, true, KeepShading::kNone));
    motion_ = without_gil([&] { return input_->motion(); });
    name_ = input_->name();
  }
  ReadMotion(const Array<float>& positions, const Array<std::uint32_t>& offsets, const Array<std::uint32_t>& corners,
             const Array<double>& times)
      : own_(std::make_unique<Motion>(motion_of(positions, offsets, corners, times))),
        motion_(own_.get()),
        name_("arrays") {}
  // Restores a motion from the state of a pickle.
  explicit ReadMotion(const py::tuple& state);
  [[nodiscard]] py::tuple state() const;

  [[nodiscard]] const Motion& motion() const {
    require_made(motion_ != nullptr);
    return *motion_;
  }
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

  // Returns the array of all keyframes, which is made at the first call.
  py::array positions() {
    require_made(motion_ != nullptr);
    if (!positions_) {
      std::vector<float> all;
      for (const Motion::Keyframe& keyframe : motion().keyframes)
        all.insert(all.end(), keyframe.positions.begin(), keyframe.positions.end());
      positions_ = array_of(std::move(all),
                            {py::ssize_t(motion().keyframes.size()), py::ssize_t(motion().topology.vertex_count()), 3});
    }
    return *positions_;
  }

  [[nodiscard]] py::object velocities() const {
    std::vector<float> all;
    for (const Motion::Keyframe& keyframe : motion().keyframes) {
      if (keyframe.velocities.empty()) return py::none();
      all.insert(all.end(), keyframe.velocities.begin(), keyframe.velocities.end());
    }
    return array_of(std::move(all),
                    {py::ssize_t(motion().keyframes.size()), py::ssize_t(motion().topology.vertex_count()), 3});
  }

  [[nodiscard]] std::array<double, 3> origin() const { return motion().origin; }

  // Returns an array (F, k) if all faces have equally many corners, or else the tuple (offsets, corners).
  [[nodiscard]] py::object faces() const {
    const Topology& topology = motion().topology;
    std::vector<std::uint32_t> corners(topology.corners().begin(), topology.corners().end()), offsets = {0};
    const std::size_t width = topology.face_count() > 0 ? topology.face(0).size() : 3;
    bool is_even = true;
    for (std::size_t f = 0; f < topology.face_count(); ++f) {
      is_even = is_even && topology.face(f).size() == width;
      offsets.push_back(offsets.back() + static_cast<std::uint32_t>(topology.face(f).size()));
    }
    if (is_even) return array_of(std::move(corners), {py::ssize_t(topology.face_count()), py::ssize_t(width)});
    const auto count = static_cast<py::ssize_t>(corners.size());
    return py::make_tuple(array_of(std::move(offsets), {py::ssize_t(topology.face_count() + 1)}),
                          array_of(std::move(corners), {count}));
  }

  [[nodiscard]] py::array times() const {
    std::vector<double> times;
    for (const Motion::Keyframe& keyframe : motion().keyframes) times.push_back(keyframe.time);
    return array_of(std::move(times), {py::ssize_t(motion().keyframes.size())});
  }
  [[nodiscard]] py::list names() const {
    py::list names;
    for (const Motion::Keyframe& keyframe : motion().keyframes) names.append(string_of(keyframe.name));
    return names;
  }
  [[nodiscard]] py::array segments() const {
    std::vector<std::int64_t> keys;
    for (const auto& [from, to] : motion().segments) {
      keys.push_back(static_cast<std::int64_t>(from));
      keys.push_back(static_cast<std::int64_t>(to));
    }
    return array_of(std::move(keys), {py::ssize_t(motion().segments.size()), 2});
  }
  [[nodiscard]] std::string kind() const {
    return motion().segments.empty() ? "mesh" : std::string(motion_kind_name(motion().kind));
  }

  py::array unit_normals(const std::optional<Array<double>>& times, const std::optional<Array<double>>& weights,
                         const std::string& elements, double crease, const std::string& weighting, bool weld,
                         const std::string& scheme) {
    SampleOptions options;
    options.scheme = scheme;
    options.elements.kind = value_or_raise(make_element_kind(elements));
    options.elements.crease_angle = crease;
    options.elements.weld = weld;
    options.weighting = value_or_raise(make_weighting(weighting));
    require(!times || !weights, "weights",
            "times and weights cannot be given together; give weights for blend shapes, times for other motions");
    require(times || weights || motion().segments.empty(), "times",
            "the times are missing; give times, or weights for blend shapes");
    std::vector<double> at;
    std::size_t rows = 1, width = 0;
    if (times) {
      if (times->ndim() != 1)
        refuse("times", "the shape must be (T,), a number for each of T moments, but is " + shape_text(*times));
      at = vector_of(*times);
      rows = at.size();
    } else if (weights) {
      if (weights->ndim() != 2)
        refuse("weights", "the shape must be (T, K), K weights for each of T moments, but is " + shape_text(*weights));
      at = vector_of(*weights);
      rows = static_cast<std::size_t>(weights->shape(0));
      width = static_cast<std::size_t>(weights->shape(1));
    }
    std::size_t count = 0;
    std::vector<float> all = without_gil([&]() -> Result<std::vector<float>> {
      Result<NormalSampler> sampler = NormalSampler::make(motion(), options);
      if (!sampler) return sampler.error();
      count = sampler.value().output_count();
      std::vector<float> normals;
      for (std::size_t r = 0; r < rows; ++r) {
        check_interruption();
        const Result<Pose> pose = times     ? sampler.value().at_time(at[r])
                                  : weights ? sampler.value().at_weights({at.data() + r * width, width})
                                            : Result<Pose>(sampler.value().at_rest());
        if (!pose) return pose.error();
        const std::vector<float> of_pose = sampler.value().normals_of_outputs(pose.value());
        normals.insert(normals.end(), of_pose.begin(), of_pose.end());
      }
      return normals;
    });
    return array_of(std::move(all), {py::ssize_t(rows), py::ssize_t(count), 3});
  }

  [[nodiscard]] py::str text() const {
    require_made(motion_ != nullptr);
    return string_of("<chronormal.Motion " + name_ + ": " + kind() + ", " + std::to_string(motion().keyframes.size()) +
                     (motion().keyframes.size() == 1 ? " keyframe of " : " keyframes of ") +
                     counted(motion().topology.vertex_count(), ElementKind::kVertices) + ", " +
                     counted(motion().topology.face_count(), ElementKind::kFaces) + ">");
  }

 private:
  py::object bytes_;  // owns the bytes to which the input refers
  std::optional<Input> input_;
  std::unique_ptr<Motion> own_;
  const Motion* motion_ = nullptr;  // the motion of the input or of the arrays
  std::string name_;
  std::optional<py::array> positions_;
};

// Returns the state of a motion for a pickle: everything except the files from which the motion was read.
py::tuple ReadMotion::state() const {
  const Motion& m = motion();
  py::list keyframes;
  for (const Motion::Keyframe& keyframe : m.keyframes) {
    const auto bytes = [](const auto& values) {
      return py::bytes(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
    };
    keyframes.append(py::make_tuple(bytes(keyframe.positions), keyframe.time, string_of(keyframe.name),
                                    bytes(keyframe.velocities), bytes(keyframe.end_velocities),
                                    bytes(keyframe.residuals)));
  }
  std::vector<std::uint32_t> offsets = {0};
  for (std::size_t f = 0; f < m.topology.face_count(); ++f)
    offsets.push_back(offsets.back() + static_cast<std::uint32_t>(m.topology.face(f).size()));
  std::vector<std::pair<std::size_t, std::size_t>> segments;
  for (const auto& [from, to] : m.segments) segments.emplace_back(from, to);
  const auto corners = m.topology.corners();
  return py::make_tuple(kStateVersion, string_of(name_), m.topology.vertex_count(), offsets,
                        std::vector<std::uint32_t>(corners.begin(), corners.end()), keyframes, segments,
                        m.body_of_vertex, static_cast<int>(m.kind), m.origin);
}

ReadMotion::ReadMotion(const py::tuple& state) {
  require(state.size() == 10 && state[0].cast<int>() == kStateVersion, "state",
          "another version of chronormal has made this pickle; make the pickle again with this version");
  name_ = bytes_of_text(state[1]);
  Motion m;
  const auto offsets = state[3].cast<std::vector<std::uint32_t>>();
  m.topology = value_or_raise(
      Topology::polygons(state[2].cast<std::size_t>(), offsets, state[4].cast<std::vector<std::uint32_t>>()));
  for (const py::handle each : state[5].cast<py::list>()) {
    const auto parts = each.cast<py::tuple>();
    require(parts.size() == 6, "state",
            "the pickle is damaged, since a keyframe must have six parts; make the pickle again");
    const auto read = [&](std::size_t i, auto& values) {
      const auto bytes = parts[i].cast<std::string_view>();
      values.resize(bytes.size() / sizeof(values[0]));
      std::memcpy(values.data(), bytes.data(), values.size() * sizeof(values[0]));
    };
    Motion::Keyframe& keyframe = m.keyframes.emplace_back();
    read(0, keyframe.positions);
    keyframe.time = parts[1].cast<double>();
    keyframe.name = bytes_of_text(parts[2]);
    read(3, keyframe.velocities);
    read(4, keyframe.end_velocities);
    read(5, keyframe.residuals);
  }
  for (const auto& [from, to] : state[6].cast<std::vector<std::pair<std::size_t, std::size_t>>>()) {
    require(from < m.keyframes.size() && to < m.keyframes.size(), "state",
            "the pickle is damaged, since a segment refers to a keyframe that does not exist; make the pickle again");
    m.segments.push_back({from, to});
  }
  m.body_of_vertex = state[7].cast<std::vector<std::uint32_t>>();
  m.kind = static_cast<MotionKind>(std::clamp(state[8].cast<int>(), 0, 2));
  m.origin = state[9].cast<std::array<double, 3>>();
  if (!m.segments.empty()) value_or_raise(validate(m));
  own_ = std::make_unique<Motion>(std::move(m));
  motion_ = own_.get();
}

// The input of a call: files that were opened, or a Motion of Python. `kept` owns the bytes of the input.
struct Opened {
  std::optional<Input> input;
  const ReadMotion* made = nullptr;
  py::object kept;

  [[nodiscard]] const GltfDocument* document() const { return input ? input->document() : nullptr; }
  [[nodiscard]] std::string name() const { return input ? input->name() : made->name(); }
  [[nodiscard]] Result<const Motion*> motion() { return input ? input->motion() : &made->motion(); }
  [[nodiscard]] Result<const StoredNormals*> normals() {
    static const StoredNormals none;  // a Motion has no stored normals
    return input ? input->normals() : &none;
  }
  [[nodiscard]] std::optional<CutPath> cut() const {
    return input && input->cut_path().path.is_curved() ? std::optional(input->cut_path()) : std::nullopt;
  }
  [[nodiscard]] Expansion expansion() const { return input ? input->expansion() : Expansion::unlimited(); }
};

Opened open(const py::dict& source, KeepShading shading) {
  Opened opened;
  if (const py::object motion = source["motion"]; !motion.is_none()) {
    opened.made = &motion.cast<const ReadMotion&>();
    require(!opened.made->motion().segments.empty(), "source",
            "the mesh does not move, so there is nothing to judge; give a Motion with at least two keyframes");
    opened.kept = motion;
  } else {
    opened.input.emplace(open_files(source, false, shading));
    opened.kept = source["bytes"];
  }
  return opened;
}

py::list dicts_of(std::vector<ErrorTable> tables) {
  py::list list;
  for (ErrorTable& table : tables) {
    const auto rows = static_cast<py::ssize_t>(table.rows()), columns = static_cast<py::ssize_t>(table.columns());
    py::dict dict;
    dict["name"] = string_of(table.name);
    dict["errors"] = array_of(std::move(table.degrees), {rows, columns});
    dict["subjects"] = array_of(std::move(table.subjects), {rows});
    dict["times"] = array_of(std::move(table.times), {rows});
    dict["weights"] = array_of(std::move(table.weights), {rows});
    dict["positions"] = array_of(std::move(table.positions), {py::ssize_t(table.topology.vertex_count()), 3});
    if (!table.primitives.empty()) {
      dict["primitives"] = array_of(std::move(table.primitives), {columns});
      dict["vertices"] = array_of(std::move(table.vertices), {columns});
    }
    list.append(dict);
  }
  return list;
}

py::tuple audit_source(const py::dict& source, const std::string& rule, const std::string& weighting,
                       const std::string& viewers, std::optional<std::size_t> samples, std::optional<double> tolerance,
                       bool weld, bool keep_errors) {
  AuditOptions options;
  if (!rule.empty()) options.rule = value_or_raise(make_audit_rule(rule));
  if (!weighting.empty()) options.weighting = value_or_raise(make_weighting(weighting));
  if (!viewers.empty()) options.viewers = value_or_raise(find_viewers(viewers));
  require(!tolerance || *tolerance >= 0, "tolerance", "the tolerance must be an angle in degrees, at least 0");
  options.samples = samples;
  options.weld = weld;
  options.keep_errors = keep_errors;
  Opened input = open(source, KeepShading::kAll);
  options.animation = source["animation"].cast<std::string>();
  Audit found = without_gil([&]() -> Result<Audit> {
    if (input.document() != nullptr) return audit(*input.document(), options);
    const Result<const Motion*> motion = input.motion();
    if (!motion) return motion.error();
    const Result<const StoredNormals*> normals = input.normals();
    if (!normals) return normals.error();
    return audit(*motion.value(), *normals.value(), options);
  });
  found.cut = input.cut();
  return py::make_tuple(audit_json(input.name(), found, {tolerance}), dicts_of(std::move(found.errors)));
}

py::tuple compare_source(const py::dict& source, const std::vector<std::string>& schemes, std::size_t samples,
                         bool sequential, const std::string& elements, double crease, bool weld, bool with_times,
                         bool keep_errors, bool certified, std::optional<double> tolerance) {
  CompareOptions options;
  options.schemes = schemes;
  options.samples = samples;
  options.access = sequential ? Access::kSequential : Access::kRandom;
  options.elements.kind = value_or_raise(make_element_kind(elements));
  options.elements.crease_angle = crease;
  options.elements.weld = weld;
  options.keep_errors = keep_errors;
  options.certify = certified;
  options.tolerance = tolerance;
  Opened input = open(source, KeepShading::kNone);
  NamedComparison found = without_gil([&]() -> Result<NamedComparison> {
    const Result<const Motion*> motion = input.motion();
    if (!motion) return motion.error();
    Result<Comparison> comparison = compare(*motion.value(), options);
    if (!comparison) return comparison.error();
    comparison.value().cut = input.cut();
    return NamedComparison{input.name(), std::move(comparison).value()};
  });
  std::vector<ErrorTable> tables = std::move(found.comparison.errors);
  return py::make_tuple(compare_json({std::move(found)}, false, with_times), dicts_of(std::move(tables)));
}

std::string figure_of_face(const py::dict& source, const std::vector<std::string>& schemes, std::size_t samples,
                           std::size_t face, std::size_t segment) {
  Opened input = open(source, KeepShading::kNone);
  const FaceFigure figure = without_gil([&]() -> Result<FaceFigure> {
    const Result<const Motion*> motion = input.motion();
    if (!motion) return motion.error();
    return face_figure(*motion.value(), {face, segment, schemes, samples});
  });
  return face_figure_json(input.name(), figure);
}

std::string inspect_source(const py::dict& source) {
  if (const py::object motion = source["motion"]; !motion.is_none()) {
    const auto& given = motion.cast<const ReadMotion&>();
    return inspect_json(
        without_gil([&]() -> Result<Inspected> { return inspect_input(given.motion(), given.name()); }));
  }
  Input input = open_files(source, true, KeepShading::kNone);
  const std::string animation = source["animation"].cast<std::string>();
  return inspect_json(without_gil([&] { return inspect_input(std::move(input), animation); }));
}

// Bakes a glTF document. Returns the bytes of the GLB, and writes the report into `json`.
std::string bake_document(const Opened& input, const BakeOptions& options, std::string& json) {
  const GltfDocument& document = *input.document();
  GltfEdit edit(document);
  const GltfBake baked = without_gil([&] { return bake(document, options, edit); });
  json = bake_json(baked, {input.name(), kBytes, std::nullopt, std::nullopt});
  return without_gil([&] { return edit.bytes("baked.glb"); });
}

std::string bake_sequence_of(Opened& input, BakeOptions options, std::string& json) {
  std::string glb;
  SequenceBake baked = without_gil([&]() -> Result<SequenceBake> {
    const Result<const Motion*> motion = input.motion();
    if (!motion) return motion.error();
    if (motion.value()->kind == MotionKind::kTargets)
      return invalid_input(
          input.name(),
          "the input is a base with targets, not a sequence; write both as a glTF file first, and bake that file");
    if (motion.value()->segments.size() + 1 != motion.value()->keyframes.size())
      return invalid_input(
          input.name(),
          "the weights of this animation jump, so it cannot be baked as a sequence; bake the glTF file itself");
    const Result<const StoredNormals*> stored = input.normals();
    if (!stored) return stored.error();
    if (!stored.value()->of_keyframes.empty()) {
      const std::vector<float>& first = stored.value()->of_keyframes.front();
      options.normal_of_corner = VectorView<const float>::packed(first.data(), first.size() / 3);
      options.normals_of_keyframe = [&](std::size_t k) -> Result<std::vector<float>> {
        const std::vector<std::vector<float>>& all = stored.value()->of_keyframes;
        return k < all.size() ? all[k] : std::vector<float>();
      };
    }
    const Expansion allowed = input.expansion();
    options.expansion = &allowed;
    return bake_sequence(*motion.value(), options, glb);
  });
  baked.cut = input.cut();
  json = bake_json(baked, options.encoding.value_or(BakeEncoding::kExact),
                   {input.name(), kBytes, std::nullopt, std::nullopt});
  return glb;
}

py::tuple bake_source(const py::dict& source, const std::string& encode, const std::string& viewers,
                      const std::string& weighting, std::optional<double> tolerance, bool smooth, bool recompute_base) {
  BakeOptions options;
  if (!encode.empty()) {
    options.encoding = find_bake_encoding(encode);
    require(options.encoding.has_value(), "encode", "the encoding must be smallest, harmless, exact, endpoint or keys");
  }
  if (!viewers.empty()) options.viewers = value_or_raise(find_viewers(viewers));
  if (!weighting.empty()) options.weighting = value_or_raise(make_weighting(weighting));
  require(!tolerance || (*tolerance >= 0 && *tolerance <= 90), "tolerance",
          "the tolerance must be an angle from 0 to 90 degrees");
  options.tolerance = tolerance;
  options.smooth = smooth;
  options.recompute_base = recompute_base;
  Opened input = open(source, KeepShading::kAll);
  const bool is_document = input.document() != nullptr;
  if (!is_document) {
    require(options.encoding != BakeEncoding::kSmallest, "encode",
            "the encoding of a sequence must be harmless, exact, endpoint or keys");
    require(!smooth && !recompute_base, "smooth, recompute_base",
            "these options are only for glTF files, and the input is a sequence; leave them out");
  }
  std::string json;
  const std::string glb = is_document ? bake_document(input, options, json) : bake_sequence_of(input, options, json);
  return py::make_tuple(py::bytes(glb), json);
}

}  // namespace

void add_files(py::module_& module) {
  module.def("audit", &audit_source);
  module.def("compare", &compare_source);
  module.def("figure_of_face", &figure_of_face);
  module.def("inspect", &inspect_source);
  module.def("bake", &bake_source);
  module.def("schemes", [] {
    py::dict all;
    for (const SchemeDescription& scheme : scheme_descriptions())
      all[string_of(scheme.name)] = string_of(scheme.summary);
    return all;
  });
  py::class_<ReadMotion> motion(
      module, "Motion",
      R"(A motion that chronormal.read() read or chronormal.motion() made: T keyframes of V vertices.)");
  motion.def(py::init<const py::dict&>())
      .def(py::init<const Array<float>&, const Array<std::uint32_t>&, const Array<std::uint32_t>&,
                    const Array<double>&>())
      .def(py::pickle([](const ReadMotion& self) { return self.state(); },
                      [](const py::tuple& state) { return std::make_unique<ReadMotion>(state); }))
      .def_property_readonly(
          "positions", &ReadMotion::positions,
          "The position of each vertex at each keyframe, (T, V, 3) float32; the same array each time.")
      .def_property_readonly("origin", &ReadMotion::origin,
                             "The point [x, y, z] from which positions are measured. It is 0, 0, 0, unless the file "
                             "has a mesh so far from there that float32 cannot hold its digits.")
      .def_property_readonly("faces", &ReadMotion::faces,
                             "The vertices of each face, as curves() takes them: (F, k) uint32 if all faces have k "
                             "corners, else (offsets, corners).")
      .def_property_readonly("velocities", &ReadMotion::velocities,
                             "The velocity of each vertex at each keyframe, in units per second, (T, V, 3) float32; "
                             "None if the file has none.")
      .def_property_readonly("times", &ReadMotion::times,
                             "The time of each keyframe in seconds, or its weight if it is a target; (T,) float64.")
      .def_property_readonly("names", &ReadMotion::names, "The name of each keyframe: a file, a target, or \"\".")
      .def_property_readonly("segments", &ReadMotion::segments,
                             "The keyframes at the start and the end of each segment, (S, 2) int64.")
      .def_property_readonly("kind", &ReadMotion::kind,
                             "What the motion was made from: \"sequence\", \"targets\", \"animation\" or \"mesh\".")
      .def("unit_normals", &ReadMotion::unit_normals, py::arg("times") = py::none(), py::arg("weights") = py::none(),
           py::arg("elements") = "vertices", py::arg("crease") = 180.0, py::arg("weighting") = "area",
           py::arg("weld") = true, py::arg("scheme") = "",
           R"(Return the unit normals at chosen moments: (T, n, 3) float32, bit for bit as `chronormal sample`
writes them.

times    (T,) seconds of a sequence or an animation
weights  (T, K) weights of K targets
scheme   a name of schemes(), which interpolates between the exact normals at keyframes; "": exact at every time
For a mesh that does not move, leave out both times and weights.)")
      .def("__repr__", &ReadMotion::text);
}

}  // namespace chronormal::python
