#pragma once
// A mosaic reads files of its own folder and below, unless the user allows others.

namespace tafoni::io {

/// From now on VRTs may name files of this machine wherever they lie; else a stranger's VRT could make what
/// is read here part of a mesh that is given away.
void allow_outside(bool allowed = true);
bool outside_allowed();

}  // namespace tafoni::io
