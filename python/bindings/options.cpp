#include "options.hpp"

#include <iterator>
#include <map>
#include <memory>
#include <typeindex>

#include "dynasurf/cloud/lod.hpp"
#include "dynasurf/cloud/options.hpp"
#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/dynamics/options.hpp"
#include "dynasurf/field/edge_map.hpp"
#include "dynasurf/field/gvf.hpp"
#include "dynasurf/image/edges.hpp"
#include "dynasurf/organ/organ.hpp"
#include "dynasurf/synthetic/camera.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"
#include "dynasurf/synthetic/options.hpp"
#include "dynasurf/ventricle/options.hpp"

#include "bindings.hpp"

namespace dynasurf::python {
namespace {

/// Options of some type, and their members.
struct AnyOptions {
  std::shared_ptr<void> options;
  OptionNodes nodes;
};

template <Described O>
AnyOptions make_options() {
  const auto made = std::make_shared<O>();
  return {made, nodes_of(*made)};
}

/// The types of the structs that members hold: of a group its own, of a family that of every method.
struct TypeCollector {
  std::map<std::string_view, std::vector<std::type_index>> types;

  template <class T>
  void operator()(std::string_view name, T& value, const OptionInfo&) {
    if constexpr (IsVariant<T>::value)
      add_methods(name, value);
    else if constexpr (Described<T>)
      types[name] = {typeid(T)};
  }
  template <class... A>
  void add_methods(std::string_view name, const std::variant<A...>&) {
    types[name] = {typeid(A)...};
  }
};

/// The names that Python gives to the options structs, and what it does with them. All but their members is the same
/// code for every type.
class Catalog {
 public:
  struct Entry {
    std::string name;  // "field.SteadyGvf"
    std::string method;
    AnyOptions (*make)();
    py::list members;
  };

  /// Options that hold others come after them.
  template <Described O>
  void add(const std::string& name) {
    std::string method;
    if constexpr (requires { O::name; }) method = O::name;
    O options;
    TypeCollector collector;
    describe(collector, options);
    keep(Entry{name, method, &make_options<O>, py::list()}, typeid(O), collector.types);
  }

  const std::vector<Entry>& entries() const { return entries_; }
  const Entry& entry(const std::string& name) const {
    for (const Entry& e : entries_)
      if (e.name == name) return e;
    throw OptionError("there are no options called " + name);
  }

 private:
  using Types = std::map<std::string_view, std::vector<std::type_index>>;

  void keep(Entry entry, std::type_index type, const Types& types);
  void tell_type(py::dict& member, const OptionNode& node, const Types& types) const;

  std::vector<Entry> entries_;
  std::map<std::type_index, std::string> names_;
};

void Catalog::keep(Entry entry, std::type_index type, const Types& types) {
  const AnyOptions made = entry.make();
  for (const OptionNode& node : made.nodes) {
    py::dict member;
    member["name"] = std::string(node.name);
    member["doc"] = std::string(node.field.doc);
    member["unit"] = std::string(node.field.unit);
    member["min"] = node.field.min;
    member["max"] = node.field.max;
    tell_type(member, node, types);
    entry.members.append(member);
  }
  names_[type] = entry.name;
  entries_.push_back(std::move(entry));
}

/// The words for the alternatives of OptionRef that are plain values, in their order.
constexpr const char* plain_kinds[] = {
    "float",        "int",        "int",         "bool",          "str",
    "float | None", "int | None", "list of int", "list of float", "list of 3 float | None"};

static_assert(std::size(plain_kinds) + 3 == std::variant_size_v<OptionRef>,
              "words, families and groups are the others");

void Catalog::tell_type(py::dict& member, const OptionNode& node, const Types& types) const {
  if (const auto* word = std::get_if<WordRef>(&node.ref)) {
    py::list words;
    for (const std::string_view w : word->words) words.append(std::string(w));
    member["kind"] = "word";
    member["words"] = words;
    return;
  }
  if (node.ref.index() < std::size(plain_kinds)) {
    member["kind"] = plain_kinds[node.ref.index()];
    return;
  }
  py::list classes;
  for (const std::type_index type : types.at(node.name)) {
    const auto found = names_.find(type);
    if (found == names_.end()) throw std::logic_error(std::string("options without a name: ") + type.name());
    classes.append(found->second);
  }
  const bool is_group = std::holds_alternative<GroupRef>(node.ref);
  member["kind"] = is_group ? "group" : "family";
  member["classes"] = is_group ? py::object(py::tuple(classes)) : py::object(classes);
}

void add_stages(Catalog& all) {
  all.add<image::Canny>("image.Canny");
  all.add<image::CannyRevised>("image.CannyRevised");
  all.add<image::GradientEdges>("image.GradientEdges");
  all.add<image::SobelEdges>("image.SobelEdges");
  all.add<image::Compass>("image.Compass");
  all.add<image::ContourCompletion>("image.ContourCompletion");
  all.add<field::EdgeMapOptions>("field.EdgeMapOptions");
  all.add<field::Gvf>("field.Gvf");
  all.add<field::SteadyGvf>("field.SteadyGvf");
  all.add<field::SteadyGgvf>("field.SteadyGgvf");
  all.add<field::Ggvf>("field.Ggvf");
  all.add<field::BandGvf>("field.BandGvf");
  all.add<field::BandGgvf>("field.BandGgvf");
  all.add<mesh::Placement>("mesh.Placement");
  all.add<mesh::Smoothing>("mesh.Smoothing");
  all.add<mesh::Tidy>("mesh.Tidy");
  all.add<mesh::Keyframes>("mesh.Keyframes");
}

void add_dynamics(Catalog& all) {
  all.add<dynamics::FieldForce>("dynamics.FieldForce");
  all.add<dynamics::StopVoxel>("dynamics.StopVoxel");
  all.add<dynamics::StopConv>("dynamics.StopConv");
  all.add<dynamics::UniformDrag>("dynamics.UniformDrag");
  all.add<dynamics::IntensityDrag>("dynamics.IntensityDrag");
  all.add<dynamics::FieldDrag>("dynamics.FieldDrag");
  all.add<dynamics::BorderDrag>("dynamics.BorderDrag");
  all.add<dynamics::FreeModel>("dynamics.FreeModel");
  all.add<dynamics::SpringModel>("dynamics.SpringModel");
  all.add<dynamics::RestrictedSpringModel>("dynamics.RestrictedSpringModel");
  all.add<dynamics::PlainModel>("dynamics.PlainModel");
  all.add<dynamics::CurvatureModel>("dynamics.CurvatureModel");
  all.add<dynamics::Euler>("dynamics.Euler");
  all.add<dynamics::Midpoint>("dynamics.Midpoint");
  all.add<dynamics::Rk4>("dynamics.Rk4");
  all.add<dynamics::StepDoubling>("dynamics.StepDoubling");
  all.add<dynamics::Rkf45>("dynamics.Rkf45");
  all.add<dynamics::BackwardEuler>("dynamics.BackwardEuler");
  all.add<dynamics::AutomaticSolver>("dynamics.AutomaticSolver");
  all.add<dynamics::Evolution>("dynamics.Evolution");
  all.add<dynamics::DiscreteContour>("dynamics.DiscreteContour");
}

void add_ventricle(Catalog& all) {
  all.add<ventricle::CoarseCircle>("ventricle.CoarseCircle");
  all.add<ventricle::AutoCircle>("ventricle.AutoCircle");
  all.add<ventricle::DivisionSlice>("ventricle.DivisionSlice");
  all.add<ventricle::SliceFlow>("ventricle.SliceFlow");
  all.add<ventricle::QuietPoints>("ventricle.QuietPoints");
  all.add<ventricle::Mlc>("ventricle.Mlc");
  all.add<ventricle::NoLabels>("ventricle.NoLabels");
  all.add<ventricle::SignLabels>("ventricle.SignLabels");
  all.add<ventricle::GradMagLabels>("ventricle.GradMagLabels");
  all.add<ventricle::CaseLabels>("ventricle.CaseLabels");
  all.add<ventricle::RadialLabels>("ventricle.RadialLabels");
  all.add<ventricle::Labelling>("ventricle.Labelling");
  all.add<ventricle::Closure>("ventricle.Closure");
  all.add<ventricle::Orientation>("ventricle.Orientation");
  all.add<ventricle::UserOverrides>("ventricle.UserOverrides");
  all.add<image::Preparation>("image.Preparation");
  all.add<ventricle::Settle>("ventricle.Settle");
  all.add<mesh::Tessellation>("mesh.Tessellation");
  all.add<ventricle::ContourPipeline>("ventricle.ContourPipeline");
  all.add<ventricle::MeasureOptions>("ventricle.MeasureOptions");
  all.add<psf_fit::BlurFit>("ventricle.BlurFit");
  all.add<ventricle::Options>("ventricle.Options");
  all.add<organ::Options>("ventricle.OrganOptions");
}

void add_others(Catalog& all) {
  all.add<cloud::Options>("cloud.Options");
  all.add<cloud::LodRule>("cloud.LodRule");
  all.add<synthetic::CloudPhantom>("synthetic.CloudPhantom");
  all.add<synthetic::Lattice>("synthetic.Lattice");
  all.add<synthetic::Noise>("synthetic.Noise");
  all.add<synthetic::Pose>("synthetic.Pose");
  all.add<synthetic::CupShape>("synthetic.CupShape");
  all.add<synthetic::Hebron>("synthetic.Hebron");
  all.add<synthetic::Mayo>("synthetic.Mayo");
  all.add<synthetic::Partial>("synthetic.Partial");
  all.add<synthetic::TwoSpheres>("synthetic.TwoSpheres");
  all.add<synthetic::VoxelSphere>("synthetic.VoxelSphere");
  all.add<synthetic::Gap>("synthetic.Gap");
  all.add<synthetic::CardiacCycle>("synthetic.CardiacCycle");
  all.add<synthetic::Pathology>("synthetic.Pathology");
  all.add<synthetic::Torso>("synthetic.Torso");
  all.add<synthetic::Irregularity>("synthetic.Irregularity");
  all.add<synthetic::Tags>("synthetic.Tags");
  all.add<synthetic::VirtualPatient>("synthetic.VirtualPatient");
  all.add<synthetic::Organ>("synthetic.Organ");
  all.add<synthetic::Collimator>("synthetic.Collimator");
  all.add<synthetic::Acquisition>("synthetic.Acquisition");
  all.add<synthetic::Fbp>("synthetic.Fbp");
  all.add<synthetic::Osem>("synthetic.Osem");
  all.add<synthetic::Reorientation>("synthetic.Reorientation");
  all.add<synthetic::CameraHeart>("synthetic.CameraHeart");
  all.add<synthetic::CameraPhantom>("synthetic.CameraPhantom");
}

const Catalog& catalog() {
  static const Catalog* all = [] {
    auto* made = new Catalog;  // holds Python objects: never destroyed, Python has ended before
    add_stages(*made);
    add_dynamics(*made);
    add_ventricle(*made);
    add_others(*made);
    return made;
  }();
  return *all;
}

py::list described() {
  py::list all;
  for (const Catalog::Entry& entry : catalog().entries()) {
    py::dict one;
    one["name"] = entry.name;
    one["method"] = entry.method;
    one["defaults"] = io::options_to_text(entry.make().nodes);
    one["members"] = entry.members;
    all.append(one);
  }
  return all;
}

AnyOptions read(const std::string& name, const std::string& text) {
  AnyOptions options = catalog().entry(name).make();
  if (!text.empty()) io::options_from_text(text, options.nodes, "");
  return options;
}

}  // namespace

void bind_options(py::module_& module) {
  module.def("options_described", &described, "All options structs, those that others hold first.");
  module.def(
      "options_resolve",
      [](const std::string& name, const std::string& text) { return io::options_to_text(read(name, text).nodes); },
      needed("name"), needed("text"), "JSON of all members: those that `text` names, else their defaults.");
  module.def(
      "options_set",
      [](const std::string& name, const std::string& text, const std::string& assignment) {
        const AnyOptions changed = read(name, text);
        set_option(changed.nodes, assignment);
        return io::options_to_text(changed.nodes);
      },
      needed("name"), needed("text"), needed("assignment"), "The same after one --set of the command line.");
  module.def(
      "ventricle_preset", [](const std::string& name) { return io::options_to_text(ventricle::preset(name)); },
      needed("name"));
  module.def(
      "organ_preset", [](const std::string& name) { return io::options_to_text(organ::preset(name)); }, needed("name"));
  module.def(
      "cloud_preset", [](const std::string& name) { return io::options_to_text(cloud::preset(name)); }, needed("name"));
}

}  // namespace dynasurf::python
