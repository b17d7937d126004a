#include "archive.hpp"

#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/io/options_json.hpp"

#include "pickles.hpp"
#include "version.hpp"

namespace dynasurf::python {

#define DYNASURF_ARITY(type, n) \
  template <>                   \
  inline constexpr int arity<type> = n
DYNASURF_ARITY(heart::Estimate, 2);
DYNASURF_ARITY(Note, 5);
DYNASURF_ARITY(Grid, 4);
DYNASURF_ARITY(Study, 11);
DYNASURF_ARITY(TriMesh, 2);
DYNASURF_ARITY(heart::LvShell, 5);
DYNASURF_ARITY(heart::Location, 11);
DYNASURF_ARITY(heart::BasePlane, 5);
DYNASURF_ARITY(ventricle::LeadingSurface, 2);
DYNASURF_ARITY(ventricle::LeadingSurfaces, 3);
DYNASURF_ARITY(mesh::StackVolumes, 3);
DYNASURF_ARITY(mesh::TriangleQuality, 9);
DYNASURF_ARITY(mesh::SurfaceCheck, 5);
DYNASURF_ARITY(mesh::MoveReport, 3);
DYNASURF_ARITY(mesh::Repair, 3);
DYNASURF_ARITY(dynamics::TrajectoryStep, 4);
DYNASURF_ARITY(Contour, 2);
DYNASURF_ARITY(field::VectorField, 4);
DYNASURF_ARITY(ventricle::WallContours, 8);
DYNASURF_ARITY(ventricle::Motion, 6);
DYNASURF_ARITY(ventricle::Surface, 16);
DYNASURF_ARITY(ventricle::EdgeSurfaces, 4);
DYNASURF_ARITY(ventricle::Circle, 3);
DYNASURF_ARITY(ventricle::Axis, 4);
DYNASURF_ARITY(ventricle::Labels, 8);
DYNASURF_ARITY(ventricle::Gate, 7);
DYNASURF_ARITY(ventricle::Reading, 8);
DYNASURF_ARITY(psf_fit::FittedGate, 5);
DYNASURF_ARITY(psf_fit::FittedBeat, 25);
DYNASURF_ARITY(psf_fit::FitImages, 3);
DYNASURF_ARITY(psf_fit::GaussianProfile, 2);
DYNASURF_ARITY(ventricle::Readings, 3);
DYNASURF_ARITY(heart::CurvePhases, 3);
DYNASURF_ARITY(ventricle::QualityFlag, 4);
DYNASURF_ARITY(ventricle::Anterior, 2);
DYNASURF_ARITY(ventricle::HeartAxes, 5);
DYNASURF_ARITY(ventricle::VertexThickness, 2);
DYNASURF_ARITY(ventricle::ThicknessSummary, 8);
DYNASURF_ARITY(ventricle::WallThickness, 3);
DYNASURF_ARITY(ventricle::PolarGrid, 2);
DYNASURF_ARITY(ventricle::WallMap, 8);
DYNASURF_ARITY(mesh::SurfaceMotion, 3);
DYNASURF_ARITY(ventricle::GateMeasures, 7);
DYNASURF_ARITY(ventricle::PolarMaps, 9);
DYNASURF_ARITY(ventricle::SegmentErrors, 9);
DYNASURF_ARITY(ventricle::SegmentMeasures, 14);
DYNASURF_ARITY(ventricle::PeriodicCurve, 3);
DYNASURF_ARITY(ventricle::VolumeCurveFit, 19);
DYNASURF_ARITY(ventricle::PhaseSummary, 8);
DYNASURF_ARITY(ventricle::Measures, 18);
DYNASURF_ARITY(ventricle::Result, 12);
DYNASURF_ARITY(report::InputFile, 3);
DYNASURF_ARITY(report::Provenance, 6);
DYNASURF_ARITY(PointCloud, 5);
DYNASURF_ARITY(cloud::Level, 6);
DYNASURF_ARITY(cloud::Certificate, 22);
DYNASURF_ARITY(cloud::Facts, 13);
DYNASURF_ARITY(cloud::CloudSupport, 13);
DYNASURF_ARITY(cloud::Result, 5);
DYNASURF_ARITY(io::CloudSource, 3);
DYNASURF_ARITY(report::CloudRun, 4);
DYNASURF_ARITY(io::CloudInput, 3);
#undef DYNASURF_ARITY

// Found by `archive` of what holds them: by the namespace of their first argument.

template <class A>
void archive(A& a, mesh::UntangleReport& report) {
  archive(a, static_cast<mesh::MoveReport&>(report));
  archive(a, report.rounds);
  archive(a, report.found);
  archive(a, report.left);
}

/// What only the measuring of a result needs, and measuring is over.
template <class A>
void archive(A&, std::shared_ptr<const psf_fit::WallPosterior>&) {}

/// Segments are those of a model, which their names and numbers tell.
template <class A>
void archive(A& a, ventricle::Segment& segment) {
  std::string name(segment.name);
  archive(a, name);
  archive(a, segment.number);
  if constexpr (!A::writes)
    for (const ventricle::SegmentModel model : {ventricle::SegmentModel::aha17, ventricle::SegmentModel::segments20})
      for (const ventricle::Segment& known : ventricle::segments_of(model))
        if (known.name == name && known.number == segment.number) segment = known;
}

template <class A>
void archive(A& a, ventricle::Options& options) {
  std::string text = io::options_to_text(options);
  archive(a, text);
  if constexpr (!A::writes) io::options_from_text(text, options);
}

template <class A>
void archive(A& a, OriginStudy& study) {
  archive(a, static_cast<Study&>(study));
  archive(a, study.inputs);
}
template <class A>
void archive(A& a, OriginCloud& cloud) {
  archive(a, static_cast<io::CloudInput&>(cloud));
  archive(a, cloud.inputs);
}
template <class A>
void archive(A& a, Heart& heart) {
  archive(a, heart.result);
  archive(a, heart.options);
  archive(a, heart.provenance);
  archive(a, heart.mask_sha256);
  archive(a, heart.start_sha256);
  if constexpr (!A::writes) heart.study = std::make_shared<OriginStudy>();
  archive(a, *heart.study);
}
template <class A>
void archive(A& a, Lods& lods) {
  archive(a, lods.run);
  archive(a, lods.provenance);
}

namespace {

/// Who reads it back must be the same version: members are told by their order alone.
std::string written_by() { return std::string("dynasurf ") + app::version() + " " + app::commit(); }

template <class T>
py::bytes bytes_of(const T& object) {
  Writer writer;
  std::string author = written_by();
  archive(writer, author);
  archive(writer, const_cast<T&>(object));  // a writer changes nothing
  return writer.text();
}

}  // namespace

py::bytes pickled(const OriginStudy& study) { return bytes_of(study); }
py::bytes pickled(const OriginCloud& cloud) { return bytes_of(cloud); }
py::bytes pickled(const Heart& heart) { return bytes_of(heart); }
py::bytes pickled(const Lods& lods) { return bytes_of(lods); }

template <class T>
std::shared_ptr<T> unpickled(const py::bytes& bytes) {
  Reader reader{std::string_view(bytes)};
  std::string author;
  archive(reader, author);
  if (author != written_by())
    throw InputError("the pickled object was written by " + author.substr(0, 80) + "; expected " + written_by() +
                     " (save and load keep results for other versions)");
  auto object = std::make_shared<T>();
  archive(reader, *object);
  if (!reader.is_at_end()) throw InputError("the pickled object is longer than what it holds");
  return object;
}
template std::shared_ptr<OriginStudy> unpickled(const py::bytes&);
template std::shared_ptr<OriginCloud> unpickled(const py::bytes&);
template std::shared_ptr<Heart> unpickled(const py::bytes&);
template std::shared_ptr<Lods> unpickled(const py::bytes&);

}  // namespace dynasurf::python
