#include <nlohmann/json.hpp>

#include "dynasurf/io/cloud_io.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/io/study_io.hpp"
#include "dynasurf/synthetic/camera.hpp"

#include "console.hpp"
#include "phantom_parts.hpp"
#include "phantom_truth.hpp"
#include "result_job.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The truth of the patient, in which the camera's options and what follows of them take the place of the patient's.
Json truth_of_camera(const synthetic::CameraStudy& made, const synthetic::CameraPhantom& options) {
  const synthetic::Collimator collimator = synthetic::collimator_of(options.acquisition);
  Json json = truth_of(made.truth);
  json.erase("fwhm_mm");
  json["camera"] = {{"fwhm_at_100_mm", synthetic::fwhm_at(synthetic::response_of(collimator), 100)},
                    {"sensitivity_cps_per_mbq", synthetic::sensitivity_cps_per_mbq(collimator)},
                    {"angle_deg", made.projections.angle_deg},
                    {"radius_mm", made.projections.radius_mm}};
  json["options"] = io::parse_json(io::options_to_text(options), "the options");
  return json;
}

}  // namespace

ExitCode make_acquisition(const PhantomArguments& arguments, std::stop_token stop) {
  const synthetic::CameraPhantom options = options_from<synthetic::CameraPhantom>(arguments);
  io::OutputFolder folder(arguments.out.path, arguments.out.existing());
  synthetic::CameraStudy made;
  run_with_progress(arguments.quiet, stop,
                    [&](const Progress& progress) { made = synthetic::make_camera_study(options, progress); });
  const fs::path to = folder.path();
  io::DicomWriteOptions counts;
  counts.series_description = "Dynasurf projections";
  io::write_projections(made.projections, to / "projections.dcm", counts);
  io::write_dicom(made.transaxial, to / "transaxial.dcm", finely_stored(made.transaxial, "Dynasurf transaxial"));
  io::write_dicom(made.short_axis, to / "study.dcm", finely_stored(made.short_axis, "Dynasurf short axis"));
  if (arguments.nrrd)
    io::write_nrrd(made.short_axis, to / (made.short_axis.gates.size() > 1 ? "study.seq.nrrd" : "study.nrrd"));
  Study map;
  map.gates = {made.attenuation};
  io::write_nrrd(map, to / "attenuation.nrrd");
  io::write_file(to / "truth.json", io::json_text(truth_of_camera(made, options)));
  if (made.truth.tracked) io::write_tracked_points(made.truth.tracked->points, to / "points.csv");
  write_surfaces(made.truth, to);
  if (stop.stop_requested()) throw Cancelled("stopped on request");
  folder.publish();
  if (!arguments.quiet) print(summary_of(made.truth) + "phantom: " + arguments.out.path + "\n" + line_of_moved(folder));
  return done;
}

}  // namespace dynasurf::app
