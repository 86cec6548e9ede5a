#pragma once
// How large a cave is: what its entrances, ways and passages all measure by.

namespace tafoni::landforms::impl {

/// Parameters of karst, metres. 0 stands for a size that fits the terrain, which karst.cpp puts in its place
/// before anything else is made.
struct CaveSize {
  double radius = 0;   ///< of a middling open passage
  double spacing = 0;  ///< of the nodes of a network: the radius of the Poisson spheres about them
};

}  // namespace tafoni::landforms::impl
