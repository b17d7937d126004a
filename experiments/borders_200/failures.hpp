#pragma once
#include <span>
#include <string_view>

#include "patients.hpp"

namespace dynasurf {

/// A virtual patient with something planted that may spoil the result.
struct Planted {
  Patient patient;
  synthetic::Phantom phantom;
  bool is_heart = true;  // there is a ventricle to be found
};

std::span<const std::string_view> failure_kinds();

/// The patient of the series with that number, spoilt. The same arguments give the same study.
Planted plant(std::string_view kind, int number);

std::span<const std::string_view> field_kinds();

/// The patient of the series with that number in a larger field of view with organs: "chest", "hot_liver",
/// "whole_body", "hot_gallbladder", "busy_lung". These are no failures.
Planted place_in_field(std::string_view kind, int number);

}  // namespace dynasurf
