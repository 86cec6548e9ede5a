#pragma once
// Scenes are sampled as volumes, and volumes are opened as scenes.

#include "tafoni/core/progress.h"
#include "tafoni/io/volume_file.h"
#include "tafoni/scene/build/build.h"
#include "tafoni/volume/sample.h"

namespace tafoni::scene {

/// The samples of the scene's lattice over all of its surface. A solid scene has air around it, so that the
/// volume's own surface is closed. Floating fragments, which meshing removes, are in it. Throws Error{input}
/// for a scene without a surface.
io::Volume sample_scene(const BuiltScene& scene, const volume::SampleSettings& settings,
                        Progress& progress = silent());

/// The same lattice with distances in metres to the scene's surface, which is closed: an open scene's too has
/// walls and a base here, since a level set has an inside. Values are limited to level_set_reach(). Throws as
/// sample_scene() does.
io::Volume level_set(const BuiltScene& scene, const volume::SampleSettings& settings,
                     Progress& progress = silent());

/// How far the distances of level_set() reach for such a band: at least three cells, which OpenVDB's tools
/// want. Throws Error{usage} for none and for more cells than are measured.
double level_set_reach(const BuiltScene& scene, double band);

/// The lattice that sample_scene() samples for such a band, and level_set() for such a reach with a solid
/// boundary. Throws as they do.
volume::GridFrame volume_frame(const BuiltScene& scene, double band, surface::Boundary boundary,
                               Progress& progress = silent());

/// A volume file as a scene of its own: its upper surface as the terrain, and a layer that replaces all by
/// the volume. Throws nothing; the file is opened when the scene is built.
Document volume_document(const std::string& path);

bool is_scene_file(const std::string& path);
/// A scene file (.toml), or a scene of nothing but an elevation model or a volume.
Document open_document(const std::string& path);

}  // namespace tafoni::scene
