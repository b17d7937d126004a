#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dynasurf/ventricle/measures/normal_limits.hpp"

namespace dynasurf::report {

/// Normal maps of the groups of a cohort, such as of women and men for each tracer, and that of all its studies.
struct NormalGroups {
  struct Group {
    std::vector<std::string> values;  // one a column
    int studies = 0;
    std::optional<ventricle::NormalMap> map;  // absent where there are fewer than `least` studies
  };
  std::vector<std::string> columns;  // none: a single map, `all`
  int least = 0;
  std::vector<Group> groups;
  ventricle::NormalMap all;
};

/// A perfusion map of a normal study and the group it belongs to.
struct GroupedMap {
  std::vector<std::string> values;
  ventricle::PolarValues perfusion;
};

/// The maps of all groups of at least `least` studies, and of all studies. Values that are empty are not known: such
/// studies belong to the map of all alone. Groups are in the order of their values. Throws InputError for fewer than 3
/// studies.
NormalGroups build_normal_groups(std::vector<GroupedMap> studies, const std::vector<std::string>& columns, int least,
                                 ventricle::Perfusion perfusion_is);

/// As a file: schema dynasurf.normal_groups/1, with `columns`, `least`, `all` and `groups` (`values`, `studies`, `map`
/// or null). Reading takes a file of a single map too. Throws InputError naming the file and the key, IoError.
std::string normal_groups_text(const NormalGroups& normals);
NormalGroups read_normal_groups(const std::filesystem::path& path);

/// The map for a study, and what it is of: "20 studies of sex=F". Without `wanted`, and for groups that are too small,
/// the map of all. `wanted` holds a column and a value each. Throws InputError for columns and groups that `normals`,
/// the file `name`, does not hold.
struct ChosenNormals {
  const ventricle::NormalMap* map = nullptr;
  std::string of;
};
ChosenNormals normals_for(const NormalGroups& normals, const std::vector<std::pair<std::string, std::string>>& wanted,
                          const std::string& name);

}  // namespace dynasurf::report
