#pragma once
// What a build will take of this machine: told by --dry-run, and checked before the work.

#include <string>
#include <vector>

#include "console.h"

#include "tafoni/scene/build/build.h"

namespace tafoni::cli {

/// What is made of a scene.
struct Work {
  std::vector<std::string> meshes, volumes;  ///< files
  int tiles = 1;                             ///< along each side
  bool meshed = true, picture = false;
  double pixels = 0;                    ///< of the picture
  double band = 0;                      ///< of volumes, metres
  bool half = false, distance = false;  ///< of volumes: their precision, and whether they hold distances
};

/// Prints what it would cost.
void print_cost(const scene::BuiltScene& scene, const Work& work, Console& console);

/// Throws Error{usage} for what cannot fit: more memory than is free, or more than ten times the free disk.
/// Looks closer only where that is near; what is far from it costs nothing.
void check_cost(const scene::BuiltScene& scene, const Work& work, Console& console);

/// The same for a picture of so many pixels alone, whatever it shows.
void check_picture(double pixels);

}  // namespace tafoni::cli
