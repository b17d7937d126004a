#include "options.hpp"

#include <functional>
#include <map>
#include <optional>
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

/// The names that Python gives to the options structs, and what it does with them, type by type.
class Catalog {
 public:
  struct Entry {
    std::string name;  // "field.SteadyGvf"
    std::string method;
    std::string defaults;
    py::list members;
    std::function<std::string(const std::string&)> resolve;
    std::function<std::string(const std::string&, const std::string&)> set;
  };

  /// Options that hold others come after them.
  template <Described O>
  void add(const std::string& name);

  const std::vector<Entry>& entries() const { return entries_; }
  const Entry& entry(const std::string& name) const {
    for (const Entry& e : entries_)
      if (e.name == name) return e;
    throw OptionError("there are no options called " + name);
  }

 private:
  friend struct MemberVisitor;
  std::vector<Entry> entries_;
  std::map<std::type_index, std::string> names_;
};

/// Describes members of options to Python.
struct MemberVisitor {
  Catalog& catalog;
  py::list members;

  template <class T>
  void operator()(std::string_view name, T& value, const OptionInfo& info) {
    py::dict member;
    member["name"] = std::string(name);
    member["doc"] = std::string(info.doc);
    member["unit"] = std::string(info.unit);
    member["min"] = info.min;
    member["max"] = info.max;
    tell_type(member, value);
    members.append(member);
  }

  template <class O>
  std::string name_of() {
    const auto found = catalog.names_.find(typeid(O));
    if (found == catalog.names_.end())
      throw std::logic_error(std::string("options without a name: ") + typeid(O).name());
    return found->second;
  }
  template <class... A>
  py::list names_of_family(const std::variant<A...>&) {
    py::list names;
    (names.append(name_of<A>()), ...);
    return names;
  }

  template <class T>
  void tell_type(py::dict& member, T& value) {
    if constexpr (IsVariant<T>::value) {
      member["kind"] = "family";
      member["classes"] = names_of_family(value);
    } else if constexpr (NamedEnum<T>) {
      member["kind"] = "word";
      py::list words;
      for (const std::string_view word : names_of(value)) words.append(std::string(word));
      member["words"] = words;
    } else if constexpr (std::is_same_v<T, bool>) {
      member["kind"] = "bool";
    } else if constexpr (std::is_same_v<T, std::string>) {
      member["kind"] = "str";
    } else if constexpr (std::is_same_v<T, double>) {
      member["kind"] = "float";
    } else if constexpr (std::is_integral_v<T>) {
      member["kind"] = "int";
    } else if constexpr (std::is_same_v<T, std::optional<double>>) {
      member["kind"] = "float | None";
    } else if constexpr (std::is_same_v<T, std::optional<int>>) {
      member["kind"] = "int | None";
    } else if constexpr (std::is_same_v<T, std::vector<int>>) {
      member["kind"] = "list of int";
    } else if constexpr (std::is_same_v<T, std::vector<double>>) {
      member["kind"] = "list of float";
    } else if constexpr (std::is_same_v<T, std::optional<std::array<double, 3>>>) {
      member["kind"] = "list of 3 float | None";
    } else {
      member["kind"] = "group";
      member["classes"] = py::make_tuple(name_of<T>());
    }
  }
};

template <Described O>
void Catalog::add(const std::string& name) {
  Entry entry;
  entry.name = name;
  if constexpr (requires { O::name; }) entry.method = std::string(O::name);
  entry.defaults = io::options_to_text(O{});
  MemberVisitor visitor{*this, py::list()};
  O options;
  describe(visitor, options);
  entry.members = visitor.members;
  entry.resolve = [](const std::string& text) { return io::options_to_text(options_from<O>(text)); };
  entry.set = [](const std::string& text, const std::string& assignment) {
    O changed = options_from<O>(text);
    set_option(changed, assignment);
    return io::options_to_text(changed);
  };
  names_[typeid(O)] = name;
  entries_.push_back(std::move(entry));
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
    one["defaults"] = entry.defaults;
    one["members"] = entry.members;
    all.append(one);
  }
  return all;
}

}  // namespace

void bind_options(py::module_& module) {
  module.def("options_described", &described, "All options structs, those that others hold first.");
  module.def(
      "options_resolve",
      [](const std::string& name, const std::string& text) { return catalog().entry(name).resolve(text); },
      needed("name"), needed("text"), "JSON of all members: those that `text` names, else their defaults.");
  module.def(
      "options_set",
      [](const std::string& name, const std::string& text, const std::string& assignment) {
        return catalog().entry(name).set(text, assignment);
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
