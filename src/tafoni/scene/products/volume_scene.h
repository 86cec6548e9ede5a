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

/// The lattice that sample_scene() samples for such a band. Throws as it does.
volume::GridFrame volume_frame(const BuiltScene& scene, double band, Progress& progress = silent());

/// A volume file as a scene of its own: its upper surface as the terrain, and a layer that replaces all by
/// the volume. Throws nothing; the file is opened when the scene is built.
Document volume_document(const std::string& path);

bool is_scene_file(const std::string& path);
/// A scene file (.toml), or a scene of nothing but an elevation model or a volume.
Document open_document(const std::string& path);

}  // namespace tafoni::scene
