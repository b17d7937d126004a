#include <nlohmann/json.hpp>

#include "dynasurf/io/detail/json_read.hpp"

#include "target.hpp"

bool dynasurf::fuzz::run_json(std::string_view bytes) {
  return reads("a.json", [&] {
    const nlohmann::ordered_json json = io::parse_json(bytes, "a.json");
    require(io::parse_json(io::json_text(json), "again") == json, "what is written is what was read");
  });
}
