// A plane that follows a tracked sensor cuts a model (thesis 6.2.2, fig 6.31). Replays a recorded stream of poses and
// writes the cross-section at each: sections.csv, and every sixth drawn in sections.svg.
//
//     example_sensor_plane [POSES.csv [MODEL.ply]]
//
// A pose is a line of t_ms, x, y, z, qw, qx, qy, qz: where the sensor is, and the unit quaternion that turns the
// sensor's axes into the model's. The plane goes through the sensor, square to its z axis. Without arguments the
// program records a stream of its own first, poses.csv: a hand that moves through a vase.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"

#include "svg.hpp"

using namespace dynasurf;

namespace {

struct Pose {
  double t_ms = 0;
  Vec3 place{0, 0, 0};
  Eigen::Quaterniond turn{1, 0, 0, 0};
};

std::vector<Pose> read_poses(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error(path + ": cannot be read");
  std::vector<Pose> poses;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.empty() || line[0] == '#') continue;
    for (char& c : line)
      if (c == ',') c = ' ';
    std::istringstream row(line);
    Pose p;
    double w = 0, x = 0, y = 0, z = 0;
    if (!(row >> p.t_ms >> p.place[0] >> p.place[1] >> p.place[2] >> w >> x >> y >> z))
      throw std::runtime_error(path + ": line " + std::to_string(number) + ": expected t_ms, x, y, z, qw, qx, qy, qz");
    p.turn = Eigen::Quaterniond(w, x, y, z);
    if (std::abs(p.turn.norm() - 1) > 1e-3)
      throw std::runtime_error(path + ": line " + std::to_string(number) + ": the quaternion is not of length 1");
    poses.push_back(p);
  }
  return poses;
}

/// Straight through the model along a slanted direction at constant speed, the hand rolling about it.
void record_poses(const std::string& path, const TriMesh& model, int count) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : model.vertices) box.extend(p);
  const Vec3 along = Vec3(0.3, 0.2, 1).normalized();
  const double reach = box.diagonal().norm() / 2;
  std::ofstream out(path);
  out << "# t_ms, x, y, z, qw, qx, qy, qz\n";
  out.precision(15);
  for (int n = 0; n < count; ++n) {
    const double s = (n + 0.5) / count;
    const Vec3 place = box.center() + (2 * s - 1) * reach * along;
    const Eigen::Quaterniond turn =
        Eigen::AngleAxisd(6 * s, along) * Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), along);
    out << 20 * n << ", " << place[0] << ", " << place[1] << ", " << place[2] << ", " << turn.w() << ", " << turn.x()
        << ", " << turn.y() << ", " << turn.z() << '\n';
  }
}

/// In the sensor's own x and y.
std::vector<Eigen::Vector2d> seen_by(const Pose& pose, const std::vector<Vec3>& polygon) {
  std::vector<Eigen::Vector2d> flat;
  for (const Vec3& p : polygon) flat.push_back((pose.turn.inverse() * (p - pose.place)).head<2>());
  return flat;
}

/// Positive for outer polygons, negative for holes.
double area_of(const std::vector<Eigen::Vector2d>& polygon) {
  double twice = 0;
  for (std::size_t n = 0; n + 1 < polygon.size(); ++n)
    twice += polygon[n][0] * polygon[n + 1][1] - polygon[n][1] * polygon[n + 1][0];
  return twice / 2;
}

}  // namespace

int main(int count, char** arguments) {
  try {
    const TriMesh model =
        count > 2 ? io::read_mesh(arguments[2]) : synthetic::cloud_reference(synthetic::CloudShape::vase);
    const std::string stream = count > 1 ? arguments[1] : "poses.csv";
    if (count < 2) record_poses(stream, model, 240);

    Drawing drawing;
    std::ofstream table("sections.csv");
    table << "t_ms,polygons,area\n";
    const std::vector<Pose> poses = read_poses(stream);
    double swept = 0;
    for (std::size_t n = 0; n < poses.size(); ++n) {
      const Pose& pose = poses[n];
      const Vec3 normal = pose.turn * Vec3::UnitZ();
      const auto polygons = mesh::cross_section(model, pose.place, normal);
      double area = 0;
      for (const auto& polygon : polygons) {
        auto flat = seen_by(pose, polygon);
        area += area_of(flat);
        if (n % 6 == 0) drawing.line(std::move(flat), n % 12 == 0 ? "navy" : "teal");
      }
      if (n > 0) swept += area * normal.dot(pose.place - poses[n - 1].place);
      table << pose.t_ms << ',' << polygons.size() << ',' << area << '\n';
    }
    drawing.save("sections.svg");
    if (count > 1) return 0;
    // Cavalieri: the areas along the way add up to the volume.
    const double volume = mesh::volume_mm3(model);
    std::printf("%zu poses; the sections sweep a volume of %.4f, the model has %.4f\n", poses.size(), swept, volume);
    return std::abs(swept - volume) < 0.01 * volume ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "sensor_plane: %s\n", error.what());
    return 1;
  }
}
